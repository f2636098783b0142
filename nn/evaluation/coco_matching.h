// Which detections of one category on one image count as found, at each of COCO's ten IoU thresholds.
//
// Detections choose in order of falling score. Each takes, among the ground truths that are still free and
// meet it with IoU >= threshold, the one of largest IoU (of equal ones the last). Three kinds of ground truth
// are ignored: crowds, objects outside the range of areas asked for, and those that the caller sets aside.
// They stand behind the others and are taken only by detections that no other ground truth would take; crowds
// are taken any number of times. A detection is then
//   matched   it took a ground truth that counts: a true positive
//   ignored   it took an ignored one, or took none and its own area is outside the range
//   neither   a false positive
//
// Source: Lin et al. 2014, Microsoft COCO; the COCO API's cocoeval.py, evaluateImg.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace penumbra::nn {

inline constexpr int kIouThresholds = 10;
// 0.50, 0.55, ..., 0.95, in the reference's floating-point steps.
std::array<double, kIouThresholds> iou_thresholds();

// Pixels of area, both ends included.
struct AreaRange {
  double least = 0.0, most = 0.0;

  bool contains(double area) const { return area >= least && area <= most; }
};

struct GroundTruth {
  double area = 0.0;
  bool is_crowd = false;
  bool set_aside = false;
  bool never_matched = false;  // taken like the others, but who takes it is no true positive
};

// Bit t of the sets stands for threshold t.
struct MatchOutcome {
  std::uint16_t matched = 0, ignored = 0;
};

// `ious` has a row for every detection and a column for every ground truth; `detection_areas` are in order of
// falling score. Returns one outcome a detection. Cost: 10 detections x ground truths.
std::vector<MatchOutcome> match_detections(std::span<const double> ious,
                                           std::span<const double> detection_areas,
                                           std::span<const GroundTruth> ground_truths,
                                           const AreaRange& range);

}  // namespace penumbra::nn
