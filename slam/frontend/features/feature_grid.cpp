#include "slam/frontend/features/feature_grid.h"

namespace penumbra::slam {

FeatureGrid::FeatureGrid(const std::vector<Keypoint>& keypoints, int width, int height)
    : width_(static_cast<float>(width)),
      height_(static_cast<float>(height)),
      cell_size_(std::max(kSmallestCell,
                          std::sqrt(width_ * height_ / (64.0F * static_cast<float>(keypoints.size() + 64))))),
      columns_(std::max(1, static_cast<int>(std::ceil(width_ / cell_size_)))),
      rows_(std::max(1, static_cast<int>(std::ceil(height_ / cell_size_)))),
      begin_(static_cast<std::size_t>(columns_ * rows_ + 1), 0),
      entries_(keypoints.size()) {
  // Counting sort by cell.
  const auto cell = [&](const Keypoint& k) {
    return static_cast<std::size_t>(row(k.v) * columns_ + column(k.u));
  };
  for (const Keypoint& k : keypoints) ++begin_[cell(k) + 1];
  for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
  std::vector<int> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const Keypoint& k = keypoints[i];
    const auto feature = static_cast<std::uint32_t>(i) << kLevelBits;
    entries_[static_cast<std::size_t>(next[cell(k)]++)] = {k.u, k.v,
                                                           feature | static_cast<std::uint32_t>(k.level)};
  }
}

}  // namespace penumbra::slam
