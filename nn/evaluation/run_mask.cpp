#include "nn/evaluation/run_mask.h"

#include <algorithm>

namespace penumbra::nn {

namespace {

// Adds a run that begins nowhere before the last one's begin; runs that touch become one.
void append(std::vector<PixelRun>& runs, const PixelRun& run) {
  if (run.begin == run.end) return;
  if (!runs.empty() && run.begin <= runs.back().end) {
    runs.back().end = std::max(runs.back().end, run.end);
  } else {
    runs.push_back(run);
  }
}

}  // namespace

RunMask mask_from_counts(std::span<const std::uint32_t> counts, int width, int height) {
  RunMask mask{width, height, {}};
  mask.runs.reserve(counts.size() / 2);
  std::uint32_t begin = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const std::uint32_t end = begin + counts[i];
    if (i % 2 == 1) append(mask.runs, {begin, end});
    begin = end;
  }
  return mask;
}

std::uint64_t area(const RunMask& mask) {
  std::uint64_t pixels = 0;
  for (const PixelRun& run : mask.runs) pixels += run.end - run.begin;
  return pixels;
}

CocoBox bounding_box(const RunMask& mask) {
  if (mask.runs.empty()) return {};
  const auto height = static_cast<std::uint32_t>(mask.height);
  std::uint32_t top = height - 1, bottom = 0;
  for (const PixelRun& run : mask.runs) {
    const std::uint32_t last = run.end - 1;
    const bool one_column = run.begin / height == last / height;
    top = std::min(top, one_column ? run.begin % height : 0);
    bottom = std::max(bottom, one_column ? last % height : height - 1);
  }
  const std::uint32_t left = mask.runs.front().begin / height, right = (mask.runs.back().end - 1) / height;
  return {static_cast<double>(left), static_cast<double>(top), static_cast<double>(right - left + 1),
          static_cast<double>(bottom - top + 1)};
}

std::uint64_t intersection_area(const RunMask& a, const RunMask& b) {
  std::uint64_t pixels = 0;
  auto i = a.runs.begin(), j = b.runs.begin();
  while (i != a.runs.end() && j != b.runs.end()) {
    const std::uint32_t begin = std::max(i->begin, j->begin), end = std::min(i->end, j->end);
    if (begin < end) pixels += end - begin;
    if (i->end < j->end) {
      ++i;
    } else {
      ++j;
    }
  }
  return pixels;
}

RunMask mask_union(std::span<const RunMask> masks, int width, int height) {
  std::vector<PixelRun> runs;
  for (const RunMask& mask : masks) runs.insert(runs.end(), mask.runs.begin(), mask.runs.end());
  std::sort(runs.begin(), runs.end(), [](const PixelRun& a, const PixelRun& b) { return a.begin < b.begin; });
  RunMask all{width, height, {}};
  all.runs.reserve(runs.size());
  for (const PixelRun& run : runs) append(all.runs, run);
  return all;
}

double detection_iou(const RunMask& detection, const RunMask& ground_truth, bool is_crowd) {
  const std::uint64_t common = intersection_area(detection, ground_truth);
  if (common == 0) return 0.0;
  const std::uint64_t all = is_crowd ? area(detection) : area(detection) + area(ground_truth) - common;
  return static_cast<double>(common) / static_cast<double>(all);
}

double detection_iou(const CocoBox& detection, const CocoBox& ground_truth, bool is_crowd) {
  const double width = std::min(detection.x + detection.width, ground_truth.x + ground_truth.width) -
                       std::max(detection.x, ground_truth.x);
  const double height = std::min(detection.y + detection.height, ground_truth.y + ground_truth.height) -
                        std::max(detection.y, ground_truth.y);
  if (width <= 0.0 || height <= 0.0) return 0.0;
  const double common = width * height;
  return common / (is_crowd ? detection.area() : detection.area() + ground_truth.area() - common);
}

}  // namespace penumbra::nn
