#include "slam/frontend/disparity/dense_disparity.h"

#include "nn/base/ceil_div.h"
#include "nn/base/parallel.h"

namespace penumbra::slam {

const FloatImage& DenseDisparity::find(const ByteView& left, const ByteView& right) {
  constexpr int kVector = 8;  // disparities at a time
  census_transform(left, left_);
  census_transform(right, right_);
  matching_cost(left_, right_, ceil_div(settings_.disparities, kVector) * kVector, cost_);
  parallel_for(2, 1, [&](int pass) {
    passes_[pass].run(cost_, settings_.penalties, pass == 0 ? PathPass::Way::down : PathPass::Way::up,
                      sums_[pass]);
  });
  choose_disparities(sums_[0], sums_[1], settings_.choice, disparity_);
  speckles_.apply(disparity_, static_cast<float>(settings_.piece_step), settings_.smallest_piece);
  return disparity_;
}

}  // namespace penumbra::slam
