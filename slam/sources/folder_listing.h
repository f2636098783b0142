// What is in the folders of a dataset.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra::slam {

bool is_folder(const std::filesystem::path& path);
bool is_present(const std::filesystem::path& path);

// What systems leave behind in folders: ._NAME and .DS_Store (macOS), Thumbs.db and desktop.ini (Windows),
// @eaDir (network storage), __MACOSX (zip archives).
bool is_debris(const std::filesystem::path& path);

// Entries of a folder without debris, sorted by name: 0, 1, 2, 10 (nn/base/natural_order.h). Throws
// InputError where it cannot be listed.
std::vector<std::filesystem::path> list_folder(const std::filesystem::path& folder);

// The images (.png, .jpg, .jpeg, .pgm, .ppm, .bmp, in small letters or capitals) of a folder, in that order;
// other files are left out; images of a kind that is not read with a note. Throws InputError for something
// that is no folder or has no images, and where all its images are of such a kind, with the command that
// converts them.
std::vector<std::filesystem::path> list_images(const std::filesystem::path& folder,
                                               std::vector<std::string>& notes);

// The number at the end of a name without ending, rgb_00012: 12; none where it ends in something else.
std::optional<double> number_in_name(std::string_view name);

// Throws InputError unless `path` is a folder with something in it.
void require_dataset_folder(const std::filesystem::path& path);

}  // namespace penumbra::slam
