#include "slam/brain/landmarks/similarity.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace penumbra::slam::brain {

namespace {

struct LikePair {
  float likeness = 0.0F;
  int a = 0, b = 0;
};

float cosine(const Descriptor& a, const Descriptor& b) {
  using Vector = Eigen::Matrix<float, kDescriptorSize, 1>;
  return Eigen::Map<const Vector>(a.data()).dot(Eigen::Map<const Vector>(b.data()));
}

}  // namespace

double similarity(const Landmarks& a, const Landmarks& b, const SimilaritySettings& settings) {
  const int count_a = std::min(static_cast<int>(a.size()), kMostLandmarks);
  const int count_b = std::min(static_cast<int>(b.size()), kMostLandmarks);
  const auto at = [](const Landmarks& list, int i) -> const Landmark& {
    return list[static_cast<std::size_t>(i)];
  };
  const auto interest = [&](const Landmark& landmark) {
    return settings.interest ? static_cast<double>(landmark.interest) : 1.0;
  };
  std::array<LikePair, kMostLandmarks * kMostLandmarks> pairs;
  std::size_t found = 0;
  for (int i = 0; i < count_a; ++i) {
    for (int j = 0; j < count_b; ++j) {
      if (at(a, i).landmark_class != at(b, j).landmark_class) continue;
      const float c = cosine(at(a, i).descriptor, at(b, j).descriptor);
      if (c <= settings.least_cosine) continue;
      const float likeness = (c - settings.least_cosine) / (1.0F - settings.least_cosine);
      pairs[found++] = {std::min(likeness, 1.0F), i, j};
    }
  }
  // Equal likenesses in an order that does not depend on which image comes first.
  std::sort(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(found),
            [](const LikePair& p, const LikePair& q) {
              if (p.likeness != q.likeness) return p.likeness > q.likeness;
              if (p.a + p.b != q.a + q.b) return p.a + p.b < q.a + q.b;
              return std::min(p.a, p.b) < std::min(q.a, q.b);
            });
  std::array<bool, kMostLandmarks> used_a{}, used_b{};
  double common = 0.0, all = 0.0;
  for (std::size_t k = 0; k < found; ++k) {
    const LikePair& pair = pairs[k];
    bool& taken_a = used_a[static_cast<std::size_t>(pair.a)];
    bool& taken_b = used_b[static_cast<std::size_t>(pair.b)];
    if (taken_a || taken_b) continue;
    taken_a = taken_b = true;
    common +=
        std::sqrt(interest(at(a, pair.a)) * interest(at(b, pair.b))) * static_cast<double>(pair.likeness);
  }
  for (int i = 0; i < count_a; ++i) all += interest(at(a, i));
  for (int j = 0; j < count_b; ++j) all += interest(at(b, j));
  return all > 0.0 ? std::min(1.0, 2.0 * common / all) : 0.0;
}

}  // namespace penumbra::slam::brain
