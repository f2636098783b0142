// How images of more than 8 bits a channel become images of 8.
//
// A 10- or 12-bit camera's images lie in 16-bit files. Where the levels fill the file's 16 bits, the upper 8
// stay. Most drivers store the levels as they come, 0 to 1023 or 4095: then the upper 8 of those 10 or 12
// must stay, or nearly all is lost. How many bits are used is found once and holds for the whole run, so that
// brightness keeps its meaning from frame to frame:
//
//   - as asked for (--image-bits); else
//   - as the file says (sBIT of a PNG, the largest value of a PGM), if no level of the images looked at is
//     above that; else
//   - 8, 10, 12, 14 or 16: the fewest that hold the levels of the images looked at, which are up to 16 from
//     all over the recording.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "nn/image/image_file.h"
#include "slam/sources/image_reader.h"

namespace penumbra::slam {

class ImageLevels {
 public:
  ImageLevels() = default;  // files of 8 bits, or of 16 that are filled
  // Of a recording's images, in the order of time; adds to `notes` what was found where the files have 16
  // bits, and what does not fit `bits` where that is given. Throws InputError where the first image is not
  // readable, UsageError for bits out of 8..16.
  ImageLevels(const ImageReader& reader, std::span<const ImageKey> images, std::optional<int> bits,
              std::vector<std::string>& notes);

  // Of 16-bit files, that are taken to be used.
  int bits() const { return bits_ == 0 ? 16 : bits_; }
  // As nn::read_image, with these levels.
  ByteImage read(const ImageReader& reader, const ImageKey& key, nn::ImageColour colour) const;

 private:
  int bits_ = 0;  // of 16-bit files; 0: the upper 8 of what the file says
};

}  // namespace penumbra::slam
