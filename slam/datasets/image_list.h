// Lists of images with their times, as EuRoC and TUM have them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace penumbra::slam {

struct ListedImage {
  double timestamp = 0.0;  // seconds
  std::string name;        // path below the list's folder
};

// TUM: "SECONDS NAME" a line, '#' begins a comment. EuRoC: "NANOSECONDS,NAME" a line. Throw InputError
// (file:line) for another form, a time that is no number or not after the one before, a name that leads out
// of the folder, an empty list.
std::vector<ListedImage> read_tum_image_list(const std::filesystem::path& path);
std::vector<ListedImage> read_euroc_image_list(const std::filesystem::path& path);

// The images' times.
std::vector<double> times_of(const std::vector<ListedImage>& images);

}  // namespace penumbra::slam
