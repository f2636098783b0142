#include "slam/frontend/features/patch.h"

#include <algorithm>
#include <cmath>

namespace penumbra::slam {

Patch extract_patch(const ImagePyramid& pyramid, const Keypoint& keypoint) {
  Patch patch;
  if (keypoint.level < 0 || keypoint.level >= pyramid.levels()) return patch;
  const ByteImage& image = pyramid.level(keypoint.level);
  const Eigen::Vector2f position(keypoint.u, keypoint.v);
  const Eigen::Vector2f on_level = pyramid.to_level(position, keypoint.level);
  const int x = static_cast<int>(std::lround(on_level.x())), y = static_cast<int>(std::lround(on_level.y()));
  if (x < Patch::kHalf || y < Patch::kHalf || x + Patch::kHalf >= image.width() ||
      y + Patch::kHalf >= image.height()) {
    return patch;
  }
  patch.level = keypoint.level;
  patch.offset = position - pyramid.to_full({static_cast<float>(x), static_cast<float>(y)}, keypoint.level);
  auto out = patch.pixels.begin();
  for (int dy = -Patch::kHalf; dy <= Patch::kHalf; ++dy) {
    const std::uint8_t* row = image.row(y + dy) + x - Patch::kHalf;
    out = std::copy(row, row + Patch::kWidth, out);
  }
  return patch;
}

std::vector<Patch> extract_patches(const ImagePyramid& pyramid, const FeatureView& features) {
  std::vector<Patch> patches;
  patches.reserve(static_cast<std::size_t>(features.size()));
  for (int i = 0; i < features.size(); ++i) patches.push_back(extract_patch(pyramid, features.keypoint(i)));
  return patches;
}

}  // namespace penumbra::slam
