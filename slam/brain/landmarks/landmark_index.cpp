#include "slam/brain/landmarks/landmark_index.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace penumbra::slam::brain {

LandmarkIndex::LandmarkIndex(const SimilaritySettings& settings, int shortlist)
    : settings_(settings), shortlist_(shortlist) {}

LandmarkIndex::Pooled LandmarkIndex::pool(const Landmarks& landmarks) const {
  Pooled pooled = Pooled::Zero();
  for (const Landmark& landmark : landmarks) {
    if (!stands(landmark.landmark_class)) continue;
    const float weight = settings_.interest ? std::sqrt(landmark.interest) : 1.0F;
    pooled.segment<kDescriptorSize>((landmark.landmark_class - kFirstStandingClass) * kDescriptorSize) +=
        weight * Eigen::Map<const Eigen::Matrix<float, kDescriptorSize, 1>>(landmark.descriptor.data());
  }
  const float length = pooled.norm();
  if (length > 0.0F) pooled /= length;
  return pooled;
}

int LandmarkIndex::add(const Landmarks& landmarks) {
  const Pooled pooled = pool(landmarks);
  pooled_.insert(pooled_.end(), pooled.data(), pooled.data() + kPooled);
  templates_.push_back(landmarks);
  products_.push_back(0.0F);
  order_.push_back(0);
  return size() - 1;
}

void LandmarkIndex::query(const Landmarks& landmarks, int end, std::vector<TemplateMatch>& matches) {
  matches.clear();
  const int count = std::clamp(end, 0, size());
  if (count == 0) return;
  const Pooled image = pool(landmarks);
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    products_[k] = image.dot(Eigen::Map<const Pooled>(pooled_.data() + k * kPooled));
  }
  const auto first = order_.begin(), last = first + count, kept = first + std::min(count, shortlist_);
  std::iota(first, last, 0);
  std::nth_element(first, kept, last, [&](int i, int j) {
    const float a = products_[static_cast<std::size_t>(i)], b = products_[static_cast<std::size_t>(j)];
    return a != b ? a > b : i < j;
  });
  for (auto it = first; it != kept; ++it)
    matches.push_back({*it, similarity(landmarks, templates_[static_cast<std::size_t>(*it)], settings_)});
  std::sort(matches.begin(), matches.end(), [](const TemplateMatch& a, const TemplateMatch& b) {
    return a.similarity != b.similarity ? a.similarity > b.similarity : a.number < b.number;
  });
}

}  // namespace penumbra::slam::brain
