// The disparity of most pixels of a rectified pair, by semi-global matching of census bits.
//
//   census_transform -> matching_cost -> PathPass (down, up) -> choose_disparities -> SpeckleFilter
//
// Each step's header has its formula. Deterministic: the same bits on any number of threads. After the first
// pair of a size memory is only allocated for rows. Cost: 3.5 ms on one thread for 310 x 94 pixels and 32
// disparities (docs/benchmarks.md), of which the steps' headers say their shares; 5 bytes a pixel and
// disparity.
#pragma once

#include "slam/frontend/disparity/chosen_disparity.h"
#include "slam/frontend/disparity/matching_cost.h"
#include "slam/frontend/disparity/path_costs.h"
#include "slam/frontend/disparity/speckles.h"

namespace penumbra::slam {

struct DisparitySettings {
  int disparities = 32;  // pixels, from 0; rounded up to a multiple of 8
  PathPenalties penalties;
  DisparityChoice choice;
  int smallest_piece = 30;  // pixels that hang together
  double piece_step = 1.0;  // pixels of disparity between neighbours of a piece
};

class DenseDisparity {
 public:
  explicit DenseDisparity(const DisparitySettings& settings) : settings_(settings) {}

  // Grey images of one size, not empty. What is returned is valid until the next call: pixels, 0 where the
  // disparity is not known.
  const FloatImage& find(const ByteView& left, const ByteView& right);

 private:
  const DisparitySettings settings_;
  CensusImage left_, right_;
  DisparityVolume<std::uint8_t> cost_;
  DisparityVolume<std::int16_t> sums_[2];
  PathPass passes_[2];
  FloatImage disparity_;
  SpeckleFilter speckles_;
};

}  // namespace penumbra::slam
