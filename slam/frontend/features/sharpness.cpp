#include "slam/frontend/features/sharpness.h"

#include "nn/image/grey.h"

namespace penumbra::slam {

double tenengrad(const ByteView& grey, double threshold) {
  if (grey.empty()) return 0.0;
  return slope_energy(grey, threshold) / (static_cast<double>(grey.width) * grey.height);
}

bool SharpnessTest::is_sharp(const ByteView& grey) {
  if (least_share_ <= 0.0) return true;
  constexpr double kMemory = 0.9;
  const double sharpness = tenengrad(grey);
  const bool sharp = !any_ || sharpness >= least_share_ * mean_;
  mean_ = any_ ? kMemory * mean_ + (1.0 - kMemory) * sharpness : sharpness;
  any_ = true;
  return sharp;
}

}  // namespace penumbra::slam
