#include "slam/frontend/features/depth_measurement.h"

#include <cmath>

namespace penumbra::slam {

void measure_depth(const StereoCamera& camera, const Features& features, const FloatImage& depth,
                   StereoMatches& matches) {
  const std::size_t n = features.keypoints.size();
  matches.u_right.assign(n, -1.0F);
  matches.depth.assign(n, -1.0F);
  matches.count = 0;
  const float fx_baseline = static_cast<float>(camera.fx * camera.baseline);
  for (std::size_t i = 0; i < n; ++i) {
    const Keypoint& k = features.keypoints[i];
    const int x = static_cast<int>(std::lround(k.u)), y = static_cast<int>(std::lround(k.v));
    if (x < 0 || y < 0 || x >= depth.width() || y >= depth.height()) continue;
    const float z = depth.at(x, y);
    if (!(z > 0.0F) || !std::isfinite(z)) continue;
    const float u_right = k.u - fx_baseline / z;
    if (u_right < 0.0F) continue;
    matches.u_right[i] = u_right;
    matches.depth[i] = z;
    ++matches.count;
  }
}

}  // namespace penumbra::slam
