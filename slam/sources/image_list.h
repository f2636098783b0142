// Lists of images with their times, as EuRoC and TUM have them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "slam/geometry/association.h"

namespace penumbra::slam {

struct ListedImage {
  double timestamp = 0.0;  // seconds
  std::string name;        // path below the list's folder
};

struct ImageList {
  std::vector<ListedImage> images;  // each later than the one before
  std::vector<std::string> notes;   // the unit of the times, images that were left out
};

// TUM: "SECONDS NAME" a line, '#' begins a comment. EuRoC: "NANOSECONDS,NAME" a line. Times in another unit
// are taken, too, with a note (slam/geometry/time_unit.h); of images with one time the first, with a note; a
// heading without '#' is skipped with a note; EuRoC's names may begin with "data/", which is taken off.
// Throw InputError (file:line) for another form, a time that is no number or before the one before, a name
// that leads out of the folder, an empty list.
ImageList read_tum_image_list(const std::filesystem::path& path);
ImageList read_euroc_image_list(const std::filesystem::path& path);

// The notes of two lists, those of the first before those of the second.
std::vector<std::string> joined_notes(const ImageList& first, const ImageList& second);

// What pair_by_time says where images find no partner.
struct PairingTexts {
  std::string place;          // of the two lists
  std::string expected;       // of the error; "{:g}" in it stands for the seconds
  std::string first, second;  // what the note calls the images of each list, such as "colour"
};

// Images of two lists that belong together, each in one pair at most, with at most `within` seconds between
// them: places in the lists (slam/geometry/association.h). A note counts those without a partner. Throws
// InputError where there is no pair.
std::vector<TimePair> pair_by_time(const ImageList& first, const ImageList& second, double within,
                                   const PairingTexts& texts, std::vector<std::string>& notes);

}  // namespace penumbra::slam
