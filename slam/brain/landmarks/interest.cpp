#include "slam/brain/landmarks/interest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace penumbra::slam::brain {

namespace {

void weigh(Landmarks& landmarks, double rarity) {
  std::array<int, kLandmarkClasses> count{};
  for (const Landmark& landmark : landmarks) ++count[static_cast<std::size_t>(landmark.landmark_class)];
  for (Landmark& landmark : landmarks) {
    const int n = count[static_cast<std::size_t>(landmark.landmark_class)];
    landmark.interest = landmark.score * static_cast<float>(std::pow(n, -rarity));
  }
}

bool before(const Landmark& a, const Landmark& b) {
  if (a.interest != b.interest) return a.interest > b.interest;
  return std::tie(a.x0, a.y0, a.x1, a.y1, a.landmark_class) <
         std::tie(b.x0, b.y0, b.x1, b.y1, b.landmark_class);
}

bool may_join(const Landmark& a, const Landmark& b, const InterestSettings& settings) {
  const auto side = [](const Landmark& l) { return std::max(l.x1 - l.x0, l.y1 - l.y0); };
  return a.landmark_class != b.landmark_class && side(a) <= settings.join_largest_side &&
         side(b) <= settings.join_largest_side && a.x0 <= b.x1 + settings.join_gap &&
         b.x0 <= a.x1 + settings.join_gap && a.y0 <= b.y1 + settings.join_gap &&
         b.y0 <= a.y1 + settings.join_gap;
}

// `b` into `a`, the more interesting one.
void join(Landmark& a, const Landmark& b) {
  float squares = 0.0F;
  for (std::size_t k = 0; k < a.descriptor.size(); ++k) {
    a.descriptor[k] = a.interest * a.descriptor[k] + b.interest * b.descriptor[k];
    squares += a.descriptor[k] * a.descriptor[k];
  }
  const float length = std::sqrt(squares);
  for (float& value : a.descriptor) value = length > 0.0F ? value / length : 0.0F;
  a.x0 = std::min(a.x0, b.x0);
  a.y0 = std::min(a.y0, b.y0);
  a.x1 = std::max(a.x1, b.x1);
  a.y1 = std::max(a.y1, b.y1);
}

// Each landmark with the most interesting one that it may join; both take part once.
void join_touching(Landmarks& landmarks, const InterestSettings& settings) {
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    for (std::size_t j = i + 1; j < landmarks.size(); ++j) {
      if (!may_join(landmarks[i], landmarks[j], settings)) continue;
      join(landmarks[i], landmarks[j]);
      landmarks.erase(landmarks.begin() + static_cast<std::ptrdiff_t>(j));
      break;
    }
  }
}

}  // namespace

void rate(Landmarks& landmarks, const InterestSettings& settings) {
  weigh(landmarks, settings.rarity);
  std::sort(landmarks.begin(), landmarks.end(), before);
  if (settings.join) join_touching(landmarks, settings);
  if (landmarks.size() > static_cast<std::size_t>(kMostLandmarks))
    landmarks.resize(static_cast<std::size_t>(kMostLandmarks));
}

}  // namespace penumbra::slam::brain
