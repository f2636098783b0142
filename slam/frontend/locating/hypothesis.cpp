#include "slam/frontend/locating/hypothesis.h"

namespace penumbra::slam {

void Hypothesis::begin(const Frame& frame, KeyFrame* old_reference) {
  const FrameFeatures& features = *frame.features;
  const std::size_t size = static_cast<std::size_t>(features.size());
  success = false;
  T_cw = {};
  points.assign(size, nullptr);
  pixels.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    pixels[i] = FeatureView::measured_pixel(features, static_cast<int>(i));
  }
  aligned.assign(size, 0);
  movable = frame.movable;
  movable.resize(size, 0);
  loose.clear();
  looked_for.clear();
  reference = old_reference;
  report = {};
  inliers = 0;
  off_map = false;
  information.setZero();
}

}  // namespace penumbra::slam
