// Average precision and recall of a detector as COCO defines them: twelve numbers for boxes, twelve for
// masks.
//
// For one category, IoU threshold and range of areas, the detections of all images are put in order of
// falling score and matched (coco_matching.h). After the first k of them
//   precision p_k = true positives / (true + false positives),  recall r_k = true positives / objects
//   p(r) = max { p_k : r_k >= r },  0 where r is not reached
//   AP = mean of p(r) over r = 0, 0.01, ..., 1;   AR = the last r_k
// and the numbers are means of AP or AR over categories and thresholds. A category without ground truth that
// counts is left out.
//
// Source: Lin et al. 2014, Microsoft COCO; the COCO API's cocoeval.py, whose numbers these are.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "nn/evaluation/coco_annotations.h"
#include "nn/evaluation/coco_results.h"

namespace penumbra::nn {

enum class CocoRegion {
  boxes,  // overlap of bounding boxes
  masks   // overlap of segmentations
};

// AP over thresholds 0.50 to 0.95, at 0.50, at 0.75; of objects up to 32^2 pixels, up to 96^2, above; AR with
// at most 1, 10, 100 detections an image and category; AR of small, medium and large objects.
inline constexpr std::array<std::string_view, 12> kCocoNumberNames = {
    "AP", "AP50", "AP75", "APs", "APm", "APl", "AR1", "AR10", "AR100", "ARs", "ARm", "ARl"};

inline constexpr double kNoObjects = -1.0;  // the number where no object of its kind exists

struct CocoNumbers {
  std::array<double, kCocoNumberNames.size()> values{};  // 0..1 or kNoObjects

  double operator[](std::string_view name) const;  // a name of kCocoNumberNames
};

// Hidden shares of objects: from <= share < to, or <= where `to` is 1.
struct OcclusionRange {
  double from = 0.0, to = 1.0;

  bool contains(double share) const { return share >= from && (share < to || (to >= 1.0 && share <= to)); }
};

// Evaluates `results` on all images and categories of `annotations`, with which they were read.
// Throws InputError that names the file and the first entry whose box or mask is missing or faulty, of the
// kind that is compared. With `occlusion`, only objects whose hidden share lies in the range count; the
// others are ignored, as COCO ignores objects outside a range of areas: finding them is neither a hit nor a
// mistake. Detections that meet no object count as mistakes in every range. Throws InputError for an object
// without "occlusion". Cost: for every image and category detections x objects (at most 100 detections), and
// sorting.
CocoNumbers evaluate_coco(const CocoAnnotations& annotations, const CocoResults& results, CocoRegion region,
                          const std::optional<OcclusionRange>& occlusion = std::nullopt,
                          CocoRules rules = CocoRules::official);

}  // namespace penumbra::nn
