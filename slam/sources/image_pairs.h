// Which images of two folders belong together: those of one name, whatever their ending. Of two files of one
// name in a folder (000017.png, 000017.jpg) the PNG counts, which loses nothing, or else the first.
//
// Where no names are the same but each name of a folder says its side, as in 000017_left.png, left000017.png,
// L_000017.png or cam0_000017.png, the rest of the name counts.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra::slam {

struct NamedImage {
  std::filesystem::path path;
  std::string name;  // without ending, and without side where that is needed
};

struct ImagePair {
  std::size_t first = 0, second = 0;  // places in the two lists
  std::size_t place = 0;              // of the name among those of both folders
};

struct ImagePairs {
  std::vector<NamedImage> first, second;  // all images of the two folders in their order
  std::vector<ImagePair> pairs;           // in the order of their names
  std::size_t names = 0;                  // in both folders together
  std::size_t alone = 0;                  // images without a partner
  std::vector<std::string> notes;         // files that are left out
};
// `first`: left or colour images, `second`: right or depth images. Throws InputError as list_images does, and
// where no two images belong together.
ImagePairs pair_images(const std::filesystem::path& first, const std::filesystem::path& second);

}  // namespace penumbra::slam
