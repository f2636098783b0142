#include "nn/evaluation/coco_evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "nn/base/error.h"
#include "nn/evaluation/coco_matching.h"

namespace penumbra::nn {

namespace {

constexpr std::size_t kMostDetections = 100;  // of one category on one image
constexpr int kRecallSteps = 101;
constexpr std::array<AreaRange, 4> kAreaRanges = {
    {{0.0, 1e10}, {0.0, 32.0 * 32.0}, {32.0 * 32.0, 96.0 * 96.0}, {96.0 * 96.0, 1e10}}};

// What becomes a curve: detections of one category on all images.
struct RankedDetection {
  double score = 0.0;
  std::size_t rank = 0;  // among those of its image
  MatchOutcome outcome;
};

// AP and AR of one category at every threshold.
struct CategoryNumbers {
  std::array<double, kIouThresholds> average_precision{}, recall{};
};

// Mean of p(r); `precisions` and `recalls` have an entry a detection.
double interpolated_precision(std::vector<double>& precisions, const std::vector<double>& recalls) {
  for (std::size_t k = precisions.size(); k-- > 1;) {
    precisions[k - 1] = std::max(precisions[k - 1], precisions[k]);
  }
  double sum = 0.0;
  std::size_t k = 0;
  for (int step = 0; step < kRecallSteps; ++step) {
    const double recall = step == kRecallSteps - 1 ? 1.0 : step * 0.01;  // the reference's rounding
    while (k < recalls.size() && recalls[k] < recall) ++k;
    if (k == recalls.size()) break;
    sum += precisions[k];
  }
  return sum / kRecallSteps;
}

// `detections` in order of falling score; of each image only the best `most` take part.
CategoryNumbers category_numbers(const std::vector<RankedDetection>& detections, std::size_t objects,
                                 std::size_t most) {
  CategoryNumbers numbers;
  std::vector<double> precisions, recalls;
  for (std::size_t t = 0; t < kIouThresholds; ++t) {
    precisions.clear();
    recalls.clear();
    std::size_t hits = 0, misses = 0;
    for (const RankedDetection& detection : detections) {
      if (detection.rank >= most || ((detection.outcome.ignored >> t) & 1U) != 0) continue;
      ++(((detection.outcome.matched >> t) & 1U) != 0 ? hits : misses);
      precisions.push_back(static_cast<double>(hits) / static_cast<double>(hits + misses));
      recalls.push_back(static_cast<double>(hits) / static_cast<double>(objects));
    }
    numbers.recall[t] = recalls.empty() ? 0.0 : recalls.back();
    numbers.average_precision[t] = interpolated_precision(precisions, recalls);
  }
  return numbers;
}

// Mean over categories and thresholds.
class Mean {
 public:
  void add(double value) {
    sum_ += value;
    ++count_;
  }
  void add(const std::array<double, kIouThresholds>& values) {
    for (const double value : values) add(value);
  }
  double value() const { return count_ > 0 ? sum_ / static_cast<double>(count_) : kNoObjects; }

 private:
  double sum_ = 0.0;
  std::size_t count_ = 0;
};

// What belongs to one category on one image: indices into the lists of annotations and results.
struct Group {
  std::size_t category = 0, image = 0;
  std::vector<std::size_t> objects, detections;  // detections in order of falling score, the best 100
};

class Evaluation {
 public:
  Evaluation(const CocoAnnotations& annotations, const CocoResults& results, CocoRegion region,
             const std::optional<OcclusionRange>& occlusion, CocoRules rules)
      : annotations_(annotations), results_(results), region_(region), occlusion_(occlusion), rules_(rules) {}

  CocoNumbers run() {
    const std::vector<Group> groups = make_groups();
    for (auto begin = groups.begin(); begin != groups.end();) {
      auto end = begin;
      while (end != groups.end() && end->category == begin->category) ++end;
      add_category(begin, end);
      begin = end;
    }
    CocoNumbers numbers;
    for (std::size_t i = 0; i < means_.size(); ++i) numbers.values[i] = means_[i].value();
    return numbers;
  }

 private:
  using GroupIterator = std::vector<Group>::const_iterator;

  // Groups that have an object or a detection, by category, then by image id: equal scores of different
  // images stay in this order, the reference's.
  std::vector<Group> make_groups() const {
    std::vector<std::size_t> by_id(annotations_.images.size()), position(by_id.size());
    std::iota(by_id.begin(), by_id.end(), std::size_t{0});
    std::sort(by_id.begin(), by_id.end(), [&](std::size_t a, std::size_t b) {
      return annotations_.images[a].id < annotations_.images[b].id;
    });
    for (std::size_t i = 0; i < by_id.size(); ++i) position[by_id[i]] = i;

    struct Member {
      std::size_t category, image, index;
      bool is_detection;
      double score;
    };
    std::vector<Member> members;
    members.reserve(annotations_.annotations.size() + results_.results.size());
    for (std::size_t i = 0; i < annotations_.annotations.size(); ++i) {
      const CocoAnnotation& a = annotations_.annotations[i];
      members.push_back({a.category, a.image, i, false, 0.0});
    }
    for (std::size_t i = 0; i < results_.results.size(); ++i) {
      const CocoResult& r = results_.results[i];
      members.push_back({r.category, r.image, i, true, r.score});
    }
    // Stable: objects, and detections of equal score, stay in the order of their files.
    std::stable_sort(members.begin(), members.end(), [&](const Member& a, const Member& b) {
      if (a.category != b.category) return a.category < b.category;
      if (a.image != b.image) return position[a.image] < position[b.image];
      if (a.is_detection != b.is_detection) return b.is_detection;
      return a.score > b.score;
    });

    std::vector<Group> groups;
    for (const Member& member : members) {
      if (groups.empty() || groups.back().category != member.category ||
          groups.back().image != member.image) {
        groups.push_back({member.category, member.image, {}, {}});
      }
      Group& group = groups.back();
      if (!member.is_detection) {
        group.objects.push_back(member.index);
      } else if (group.detections.size() < kMostDetections) {
        group.detections.push_back(member.index);
      }
    }
    return groups;
  }

  // Of images without a size in the file the masks' own sizes count, and must be one.
  void check_sizes(const CocoImage& image, const RunMask& a, const RunMask& b) const {
    if (a.width == b.width && a.height == b.height) return;
    throw InputError(fmt::format("{}: image {}", annotations_.file, to_string(image.id)), "masks of one size",
                     fmt::format("{} x {} and {} x {} pixels", a.width, a.height, b.width, b.height));
  }

  std::vector<double> overlaps(const Group& group) const {
    std::vector<double> ious;
    ious.reserve(group.detections.size() * group.objects.size());
    const CocoImage& image = annotations_.images[group.image];
    std::vector<RunMask> objects;
    if (region_ == CocoRegion::masks && !group.detections.empty()) {
      for (const std::size_t o : group.objects) {
        objects.push_back(to_mask(annotations_.annotations[o].segmentation, image.width, image.height));
      }
    }
    for (const std::size_t d : group.detections) {
      const CocoResult& detection = results_.results[d];
      RunMask mask;
      if (region_ == CocoRegion::masks && !objects.empty()) {
        mask = to_mask(detection.segmentation, image.width, image.height);
      }
      for (std::size_t i = 0; i < group.objects.size(); ++i) {
        const CocoAnnotation& object = annotations_.annotations[group.objects[i]];
        if (region_ == CocoRegion::masks) check_sizes(image, mask, objects[i]);
        ious.push_back(region_ == CocoRegion::masks
                           ? detection_iou(mask, objects[i], object.is_crowd)
                           : detection_iou(detection.box, object.box, object.is_crowd));
      }
    }
    return ious;
  }

  void add_category(GroupIterator begin, GroupIterator end) {
    std::array<std::vector<RankedDetection>, kAreaRanges.size()> ranked;
    std::array<std::size_t, kAreaRanges.size()> objects{};
    std::vector<GroundTruth> ground_truths;
    std::vector<double> areas;
    for (auto group = begin; group != end; ++group) {
      ground_truths.clear();
      areas.clear();
      for (const std::size_t o : group->objects) {
        const CocoAnnotation& object = annotations_.annotations[o];
        const bool set_aside = occlusion_ && !occlusion_->contains(object.occlusion.value_or(0.0));
        const bool never_matched = object.has_id_0 && rules_ == CocoRules::official;
        ground_truths.push_back({object.area, object.is_crowd, set_aside, never_matched});
      }
      for (const std::size_t d : group->detections) areas.push_back(results_.results[d].area);
      const std::vector<double> ious = overlaps(*group);
      for (std::size_t r = 0; r < kAreaRanges.size(); ++r) {
        for (const GroundTruth& truth : ground_truths) {
          if (!truth.is_crowd && !truth.set_aside && kAreaRanges[r].contains(truth.area)) ++objects[r];
        }
        const std::vector<MatchOutcome> outcomes =
            match_detections(ious, areas, ground_truths, kAreaRanges[r]);
        for (std::size_t i = 0; i < outcomes.size(); ++i) {
          ranked[r].push_back({results_.results[group->detections[i]].score, i, outcomes[i]});
        }
      }
    }
    for (std::size_t r = 0; r < kAreaRanges.size(); ++r) {
      if (objects[r] == 0) continue;
      std::stable_sort(ranked[r].begin(), ranked[r].end(),
                       [](const RankedDetection& a, const RankedDetection& b) { return a.score > b.score; });
      const CategoryNumbers numbers = category_numbers(ranked[r], objects[r], kMostDetections);
      if (r > 0) {  // small, medium, large
        means_[2 + r].add(numbers.average_precision);
        means_[8 + r].add(numbers.recall);
        continue;
      }
      means_[0].add(numbers.average_precision);
      means_[1].add(numbers.average_precision[0]);  // threshold 0.50
      means_[2].add(numbers.average_precision[5]);  // threshold 0.75
      means_[6].add(category_numbers(ranked[r], objects[r], 1).recall);
      means_[7].add(category_numbers(ranked[r], objects[r], 10).recall);
      means_[8].add(numbers.recall);
    }
  }

  const CocoAnnotations& annotations_;
  const CocoResults& results_;
  CocoRegion region_;
  std::optional<OcclusionRange> occlusion_;
  CocoRules rules_;
  std::array<Mean, kCocoNumberNames.size()> means_;  // in the order of kCocoNumberNames
};

void require_regions(const CocoProblems& problems, CocoRegion region) {
  const std::optional<InputError>& problem = region == CocoRegion::masks ? problems.masks : problems.boxes;
  if (problem) throw *problem;
}

void require_occlusions(const CocoAnnotations& annotations) {
  for (std::size_t i = 0; i < annotations.annotations.size(); ++i) {
    const CocoAnnotation& object = annotations.annotations[i];
    if (object.is_crowd || object.occlusion) continue;
    throw InputError(fmt::format("{}: annotations, entry {}", annotations.file, i),
                     "a number \"occlusion\", as ranges of it are to be evaluated", "none");
  }
}

}  // namespace

double CocoNumbers::operator[](std::string_view name) const {
  const auto found = std::find(kCocoNumberNames.begin(), kCocoNumberNames.end(), name);
  if (found == kCocoNumberNames.end()) throw Error(fmt::format("no COCO number is called {}", name));
  return values[static_cast<std::size_t>(found - kCocoNumberNames.begin())];
}

CocoNumbers evaluate_coco(const CocoAnnotations& annotations, const CocoResults& results, CocoRegion region,
                          const std::optional<OcclusionRange>& occlusion, CocoRules rules) {
  require_regions(annotations.problems, region);
  require_regions(results.problems, region);
  if (occlusion) require_occlusions(annotations);
  return Evaluation(annotations, results, region, occlusion, rules).run();
}

}  // namespace penumbra::nn
