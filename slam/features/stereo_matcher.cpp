#include "slam/features/stereo_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace penumbra::slam {

namespace {

constexpr int kMaxHamming = 75;
constexpr double kRowBand = 2.0;       // pixels of the right feature's level
constexpr int kPatch = 5;              // half width of the patch, pixels of the level
constexpr int kSlide = 5;              // pixels of the level
constexpr float kMedianFactor = 2.1F;  // 1.5 * 1.4: for normal residuals the median is the deviation / 1.4

// The right features that a left feature in row v may match, for every v.
class RowTable {
 public:
  RowTable(const Features& right, const ImagePyramid& pyramid, int height)
      : begin_(std::size_t(height) + 1, 0) {
    const auto rows = [&](const Keypoint& k) {
      const double band = kRowBand * pyramid.scale_x(k.level);
      return std::pair{std::max(0, static_cast<int>(std::ceil(k.v - band))),
                       std::min(height - 1, static_cast<int>(std::floor(k.v + band)))};
    };
    for (const Keypoint& k : right.keypoints) {
      const auto [first, last] = rows(k);
      for (int r = first; r <= last; ++r) ++begin_[std::size_t(r) + 1];
    }
    for (std::size_t r = 1; r < begin_.size(); ++r) begin_[r] += begin_[r - 1];
    features_.resize(static_cast<std::size_t>(begin_.back()));
    std::vector<int> next(begin_.begin(), begin_.end() - 1);
    for (int i = 0; i < right.size(); ++i) {
      const auto [first, last] = rows(right.keypoints[std::size_t(i)]);
      for (int r = first; r <= last; ++r) features_[std::size_t(next[std::size_t(r)]++)] = i;
    }
  }
  template <typename Visit>
  void visit_row(int row, Visit&& visit) const {
    if (row < 0 || row + 1 >= static_cast<int>(begin_.size())) return;
    for (int i = begin_[std::size_t(row)]; i < begin_[std::size_t(row) + 1]; ++i)
      visit(features_[std::size_t(i)]);
  }

 private:
  std::vector<int> begin_, features_;
};

int patch_difference(const cv::Mat& left, int xl, const cv::Mat& right, int xr, int y) {
  const int offset = left.at<uchar>(y, xl) - right.at<uchar>(y, xr);
  int sum = 0;
  for (int dy = -kPatch; dy <= kPatch; ++dy) {
    const uchar* l = left.ptr<uchar>(y + dy) + xl - kPatch;
    const uchar* r = right.ptr<uchar>(y + dy) + xr - kPatch;
    for (int i = 0; i <= 2 * kPatch; ++i) sum += std::abs(l[i] - r[i] - offset);
  }
  return sum;
}

struct Refined {
  float x = 0.0F;  // column on the level
  int difference = 0;
  bool valid = false;
};

// Slides the left patch at (xl, y) along the right row around column xr.
Refined refine(const cv::Mat& left, const cv::Mat& right, int xl, int y, int xr) {
  if (y < kPatch || y + kPatch >= left.rows || y + kPatch >= right.rows || xl < kPatch ||
      xl + kPatch >= left.cols) {
    return {};
  }
  if (xr - kSlide - kPatch < 0 || xr + kSlide + kPatch >= right.cols) return {};
  std::array<int, 2 * kSlide + 1> sad{};
  for (int s = -kSlide; s <= kSlide; ++s) {
    sad[std::size_t(s + kSlide)] = patch_difference(left, xl, right, xr + s, y);
  }
  const auto best = std::min_element(sad.begin(), sad.end());
  if (best == sad.begin() || best == sad.end() - 1) return {};  // the minimum is somewhere else
  const float before = static_cast<float>(*(best - 1)), at = static_cast<float>(*best),
              after = static_cast<float>(*(best + 1));
  const float curvature = before + after - 2.0F * at;
  const float delta = curvature > 0.0F ? (before - after) / (2.0F * curvature) : 0.0F;
  return {static_cast<float>(xr + static_cast<int>(best - sad.begin()) - kSlide) + delta, *best, true};
}

}  // namespace

void match_stereo(const StereoCamera& camera, const Features& left, const Features& right,
                  const ImagePyramid& left_pyramid, const ImagePyramid& right_pyramid,
                  StereoMatches& matches) {
  const std::size_t n = left.keypoints.size();
  matches.u_right.assign(n, -1.0F);
  matches.depth.assign(n, -1.0F);
  matches.count = 0;
  const RowTable rows(right, right_pyramid, camera.height);
  const float max_disparity =
      static_cast<float>(camera.fx);  // depth = baseline: nearer is not in both images
  const float fx_baseline = static_cast<float>(camera.fx * camera.baseline);

  std::vector<std::pair<int, std::size_t>> differences;  // SAD and feature
  for (std::size_t i = 0; i < n; ++i) {
    const Keypoint& k = left.keypoints[i];
    int best_distance = kMaxHamming, best = -1;
    rows.visit_row(static_cast<int>(std::lround(k.v)), [&](int j) {
      const Keypoint& candidate = right.keypoints[std::size_t(j)];
      const float disparity = k.u - candidate.u;
      if (std::abs(candidate.level - k.level) > 1 || disparity < -1.0F || disparity > max_disparity) return;
      const int distance = hamming_distance(left.descriptors[i], right.descriptors[std::size_t(j)]);
      if (distance < best_distance) {
        best_distance = distance;
        best = j;
      }
    });
    if (best < 0 || k.level >= right_pyramid.levels()) continue;

    const Eigen::Vector2f at = left_pyramid.to_level({k.u, k.v}, k.level);
    const Keypoint& candidate = right.keypoints[std::size_t(best)];
    const Eigen::Vector2f start = right_pyramid.to_level({candidate.u, candidate.v}, k.level);
    const Refined refined = refine(
        left_pyramid.level(k.level), right_pyramid.level(k.level), static_cast<int>(std::lround(at.x())),
        static_cast<int>(std::lround(at.y())), static_cast<int>(std::lround(start.x())));
    if (!refined.valid) continue;
    const float u_right = right_pyramid.to_full({refined.x, at.y()}, k.level).x();
    const float disparity = k.u - u_right;
    if (disparity <= 0.0F || disparity > max_disparity || u_right < 0.0F) continue;
    matches.u_right[i] = u_right;
    matches.depth[i] = fx_baseline / disparity;
    differences.emplace_back(refined.difference, i);
  }
  if (differences.empty()) return;

  const auto median = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), median, differences.end());
  const float limit = kMedianFactor * static_cast<float>(median->first);
  for (const auto& [difference, i] : differences) {
    if (static_cast<float>(difference) > limit) {
      matches.u_right[i] = matches.depth[i] = -1.0F;
    } else {
      ++matches.count;
    }
  }
}

}  // namespace penumbra::slam
