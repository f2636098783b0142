#include "nn/evaluation/coco_matching.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace penumbra::nn {

namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

}  // namespace

std::array<double, kIouThresholds> iou_thresholds() {
  // As numpy.linspace computes them: an IoU that equals a threshold counts, so the last bit matters.
  constexpr double kFirst = 0.5, kLast = 0.95, kStep = (kLast - kFirst) / (kIouThresholds - 1);
  std::array<double, kIouThresholds> thresholds{};
  for (int t = 0; t < kIouThresholds; ++t) thresholds[static_cast<std::size_t>(t)] = kFirst + t * kStep;
  thresholds.back() = kLast;
  return thresholds;
}

std::vector<MatchOutcome> match_detections(std::span<const double> ious,
                                           std::span<const double> detection_areas,
                                           std::span<const GroundTruth> ground_truths,
                                           const AreaRange& range) {
  const std::size_t count = ground_truths.size();
  const auto is_ignored = [&](std::size_t g) {
    const GroundTruth& truth = ground_truths[g];
    return truth.is_crowd || truth.set_aside || !range.contains(truth.area);
  };
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto first_ignored =
      std::stable_partition(order.begin(), order.end(), [&](std::size_t g) { return !is_ignored(g); });

  const std::array<double, kIouThresholds> thresholds = iou_thresholds();
  std::vector<MatchOutcome> outcomes(detection_areas.size());
  std::vector<char> taken(count);
  for (std::size_t t = 0; t < thresholds.size(); ++t) {
    const auto bit = static_cast<std::uint16_t>(1U << t);
    std::fill(taken.begin(), taken.end(), 0);
    for (std::size_t d = 0; d < outcomes.size(); ++d) {
      double best_iou = thresholds[t];
      std::size_t best = kNone;
      const auto look_at = [&](std::size_t g) {
        if (taken[g] != 0 && !ground_truths[g].is_crowd) return;
        const double iou = ious[d * count + g];
        if (iou < best_iou) return;
        best_iou = iou;
        best = g;
      };
      std::for_each(order.begin(), first_ignored, look_at);
      const bool counts = best != kNone;
      if (!counts) std::for_each(first_ignored, order.end(), look_at);
      if (best != kNone) taken[best] = 1;
      if (counts && !ground_truths[best].never_matched) {
        outcomes[d].matched |= bit;
      } else if ((best != kNone && !counts) || !range.contains(detection_areas[d])) {
        outcomes[d].ignored |= bit;
      }
    }
  }
  return outcomes;
}

}  // namespace penumbra::nn
