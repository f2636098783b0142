// Binary masks of whole images as runs of pixels, and what evaluation asks of them without ever unpacking a
// pixel: area, overlap, union. Cost of every operation: linear in the runs.
//
// Pixels are numbered column by column, as COCO does: pixel (x, y) has number x * height + y.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace penumbra::nn {

// Pixels begin, begin + 1, ..., end - 1.
struct PixelRun {
  std::uint32_t begin = 0, end = 0;
  bool operator==(const PixelRun&) const = default;
};

// Of boxes and polygons that are read, pixels: areas and grid numbers stay exact.
inline constexpr double kLargestCoordinate = 1e8;

// A rectangle as COCO writes it, pixels; continuous, so a mask of one pixel has width 1.
struct CocoBox {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;

  double area() const { return width * height; }
  bool operator==(const CocoBox&) const = default;
};

struct RunMask {
  int width = 0, height = 0;   // of the image; width * height < 2^32
  std::vector<PixelRun> runs;  // of ones: ascending, not empty, with a gap between neighbours

  bool operator==(const RunMask&) const = default;
};

// From COCO's counts: lengths of runs of zeros and ones in turn, zeros first; they must add up to
// width * height. Runs of length 0 are taken.
RunMask mask_from_counts(std::span<const std::uint32_t> counts, int width, int height);

std::uint64_t area(const RunMask& mask);
// The smallest box around the mask; all 0 where the mask is empty.
CocoBox bounding_box(const RunMask& mask);

// Of two masks on the same image.
std::uint64_t intersection_area(const RunMask& a, const RunMask& b);
// Of any number of masks on the same image; sorts their runs.
RunMask mask_union(std::span<const RunMask> masks, int width, int height);

// How well a detection covers a ground truth:
//   IoU = |d n g| / |d u g|;  for a crowd, a region of uncounted objects, |d n g| / |d|: a detection of one
//   of them lies in it wholly but is far smaller.
// 0 where they do not meet. Source: the COCO API's maskApi.c, rleIou and bbIou.
double detection_iou(const RunMask& detection, const RunMask& ground_truth, bool is_crowd);
double detection_iou(const CocoBox& detection, const CocoBox& ground_truth, bool is_crowd);

}  // namespace penumbra::nn
