// The "segmentation" of a COCO annotation or result, in all three forms that the files know:
//
//   [[x0, y0, x1, y1, ...], ...]             polygons, the parts of one object
//   {"size": [height, width], "counts": [...]}   run lengths, see nn/evaluation/coco_rle.h
//   {"size": [height, width], "counts": "..."}   the same as text
#pragma once

#include <cstdint>
#include <vector>

#include "nn/base/json_entries.h"
#include "nn/evaluation/run_mask.h"

namespace penumbra::nn {

inline constexpr int kLargestImageSide = 65535;  // pixels, so that pixel numbers fit 32 bits

// As it stands in the file; at most one of the two is there.
struct CocoSegmentation {
  std::vector<std::vector<double>> polygons;
  RunMask mask;

  // No segmentation, written as a missing key, null or []. (An empty mask, all zeros, is one.)
  bool is_missing() const { return polygons.empty() && mask.width == 0; }
};

// Reads the entry's key "segmentation". Behind the first polygon, one of two points is taken as well and
// covers next to nothing; as the first it is refused, since the COCO API takes it for a box and fails. Throws
// InputError where it is none of the three forms: polygons of fewer than two or three points, an odd count of
// numbers or coordinates beyond kLargestCoordinate, sizes out of 1..kLargestImageSide, counts that do not add
// up to height * width.
CocoSegmentation read_segmentation(const JsonFields& fields);

// The mask on an image of this size; polygons are drawn, a mask is returned as it is.
RunMask to_mask(const CocoSegmentation& segmentation, int width, int height);

}  // namespace penumbra::nn
