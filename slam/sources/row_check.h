// Whether the two images of a stereo pair show things in the same rows, as rectified images must.
//
// Features of the two are matched by their descriptors alone, wherever they are. Of a rectified pair nearly
// all matches lie within a pixel or two of the same row. Where half of them or more lie further apart, the
// pair is not rectified, or with a wrong calibration: a rotation that is transposed, the values of another
// camera.
#pragma once

#include <optional>
#include <vector>

#include "nn/image/image.h"

namespace penumbra::slam {

struct RowOffsets {
  std::vector<float> offsets;  // pixels: row in the right image less that in the left one, of every match

  // Adds the matches of a pair of 8-bit images, grey or BGR. Cost: about 50 ms.
  void add(const ByteImage& left, const ByteImage& right);
  // Whether there are enough matches to tell anything.
  bool is_enough() const;

  struct Disagreement {
    double median = 0.0;         // pixels, downwards in the right image
    double median_length = 0.0;  // of the offsets without their sign
  };
  // None where the rows agree, or there are not enough.
  std::optional<Disagreement> disagreement() const;
};

}  // namespace penumbra::slam
