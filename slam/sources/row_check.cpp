#include "slam/sources/row_check.h"

#include <algorithm>
#include <cmath>

#include "nn/image/grey.h"
#include "slam/frontend/features/descriptor_matcher.h"
#include "slam/frontend/features/orb_extractor.h"

namespace penumbra::slam {

namespace {

constexpr int kFeatures = 1000;             // of an image
constexpr std::size_t kFewestMatches = 50;  // that tell anything
constexpr float kSameRow = 2.0F;  // pixels: what stereo matching allows a feature of the finest level

double median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void RowOffsets::add(const ByteImage& left, const ByteImage& right) {
  OrbSettings settings;
  settings.features = kFeatures;
  OrbExtractor orb(settings);
  Features in_left, in_right;
  orb.extract(to_grey(left), in_left);
  orb.extract(to_grey(right), in_right);
  for (const Match& match : match_descriptors(in_left.descriptors, in_right.descriptors, {})) {
    offsets.push_back(in_right.keypoints[static_cast<std::size_t>(match.feature)].v -
                      in_left.keypoints[static_cast<std::size_t>(match.source)].v);
  }
}

bool RowOffsets::is_enough() const { return offsets.size() >= kFewestMatches; }

std::optional<RowOffsets::Disagreement> RowOffsets::disagreement() const {
  if (!is_enough()) return std::nullopt;
  std::vector<float> lengths;
  for (const float offset : offsets) lengths.push_back(std::abs(offset));
  const Disagreement found{median(offsets), median(std::move(lengths))};
  if (found.median_length <= kSameRow) return std::nullopt;
  return found;
}

}  // namespace penumbra::slam
