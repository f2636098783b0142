#include "slam/frontend/features/stereo_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "nn/simd/kernel_table.h"
#include "slam/frontend/features/four_pixels.h"
#include "slam/frontend/features/nearest_descriptor.h"

namespace penumbra::slam {

namespace {

constexpr int kMaxHamming = 75;
constexpr double kRowBand = 2.0;    // pixels of the right feature's level
constexpr float kSamePlace = 6.0F;  // pixels: features of several levels that show one corner
constexpr int kPatch = 5;           // half width of the patch, pixels of the level
constexpr int kPatchPixels = (2 * kPatch + 1) * (2 * kPatch + 1);
constexpr int kAlignIterations = 5;
constexpr float kLeastCurvature = 100.0F;  // grey values squared: less is no texture along the row
constexpr int kSlide = 5;                  // pixels of the level
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

struct Refined {
  float x = 0.0F;  // column on the level
  int difference = 0;
  bool valid = false;
};

// Column of the right image, to a fraction of a pixel, where the patch around (x, y) of the left one fits
// best; starts at the whole column `start`. Gauss-Newton on the sum of squares (step 3).
std::optional<float> align_patch(const ByteView& left, const ByteView& right, int x, int y, int start) {
  constexpr int kSide = 2 * kPatch + 1;
  std::array<float, kPatchPixels> value, slope, product;
  for (int j = 0; j < kSide; ++j) {
    const std::uint8_t* row = left.row(y + j - kPatch) + x - kPatch;
    for_each_four<kSide>([&](int i) {
      store_four(value.data() + j * kSide + i, load_four(row + i));
      store_four(slope.data() + j * kSide + i, 0.5F * (load_four(row + i + 1) - load_four(row + i - 1)));
    });
  }
  float slope_sum = 0.0F, curvature = 0.0F;
  for (const float s : slope) slope_sum += s;
  // Without the mean slope, a difference in brightness does not matter.
  for (float& s : slope) {
    s -= slope_sum / kPatchPixels;
    curvature += s * s;
  }
  if (curvature < kLeastCurvature) return std::nullopt;

  float shift = 0.0F;
  for (int iteration = 0; iteration < kAlignIterations; ++iteration) {
    const float column = static_cast<float>(start) + shift;
    const int whole = static_cast<int>(std::floor(column));
    const float share = column - static_cast<float>(whole);
    if (whole - kPatch < 0 || whole + kPatch + 1 >= right.width) return std::nullopt;
    for (int j = 0; j < kSide; ++j) {
      const std::uint8_t* row = right.row(y + j - kPatch) + whole - kPatch;
      for_each_four<kSide>([&](int i) {
        const int n = j * kSide + i;
        const Four seen = (1.0F - share) * load_four(row + i) + share * load_four(row + i + 1);
        store_four(product.data() + n, load_four(slope.data() + n) * (seen - load_four(value.data() + n)));
      });
    }
    float sum = 0.0F;
    for (const float p : product) sum += p;
    const float step = -sum / curvature;
    shift += step;
    if (std::abs(shift) > 1.0F) return std::nullopt;
    if (std::abs(step) < 0.01F) break;
  }
  return static_cast<float>(start) + shift;
}

// Slides the left patch at (xl, y) along the right row around column xr, then aligns it.
Refined refine(const ByteView& left, const ByteView& right, int xl, int y, int xr) {
  // The row below is there so that the bytes behind the last row's end are.
  if (y < kPatch || y + kPatch + 1 >= std::min(left.height, right.height) || xl <= kPatch ||
      xl + kPatch + 1 >= left.width) {
    return {};
  }
  if (xr - kSlide - kPatch < 0 || xr + kSlide + kPatch >= right.width) return {};
  std::array<int, 2 * kSlide + 1> sad;
  static_assert(kPatch == nn::kDifferenceReach && kSlide == nn::kDifferenceReach);
  nn::kernels().image.patch_differences(left.row(y) + xl, left.pitch, right.row(y) + xr, right.pitch,
                                        sad.data());
  const auto best = std::min_element(sad.begin(), sad.end());
  if (best == sad.begin() || best == sad.end() - 1) return {};  // the minimum is somewhere else
  const int whole = xr + static_cast<int>(best - sad.begin()) - kSlide;
  const std::optional<float> x = align_patch(left, right, xl, y, whole);
  if (!x) return {};
  return {*x, *best, true};
}

// Per left feature the right feature that is nearest in Hamming distance, if no other left feature is nearer
// to that one; -1 otherwise.
std::vector<int> mutual_partners(const Features& left, const Features& right, const RowTable& rows,
                                 float max_disparity) {
  std::vector<int> partner(left.keypoints.size(), -1);
  std::vector<NearestDescriptor> of_left(left.keypoints.size(), NearestDescriptor::within(kMaxHamming));
  std::vector<NearestDescriptor> of_right(right.keypoints.size(), NearestDescriptor::within(kMaxHamming));
  for (std::size_t i = 0; i < left.keypoints.size(); ++i) {
    const Keypoint& k = left.keypoints[i];
    rows.visit_row(static_cast<int>(std::lround(k.v)), [&](int j) {
      const Keypoint& candidate = right.keypoints[std::size_t(j)];
      const float disparity = k.u - candidate.u;
      if (std::abs(candidate.level - k.level) > 1 || disparity < -1.0F || disparity > max_disparity) return;
      const int d = hamming_distance(left.descriptors[i], right.descriptors[std::size_t(j)]);
      of_left[i].offer(j, d);
      of_right[std::size_t(j)].offer(static_cast<int>(i), d);
    });
  }
  for (std::size_t i = 0; i < partner.size(); ++i) {
    const int found = of_left[i].index;
    if (found < 0) continue;
    const NearestDescriptor& back = of_right[std::size_t(found)];
    const float apart = left.keypoints[std::size_t(back.index)].u - left.keypoints[i].u;
    if (back.distance == of_left[i].distance || std::abs(apart) <= kSamePlace) partner[i] = found;
  }
  return partner;
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
  const std::vector<int> partners = mutual_partners(left, right, rows, max_disparity);
  std::vector<std::pair<int, std::size_t>> differences;  // SAD and feature
  for (std::size_t i = 0; i < n; ++i) {
    const Keypoint& k = left.keypoints[i];
    if (partners[i] < 0 || k.level >= right_pyramid.levels()) continue;
    const Eigen::Vector2f at = left_pyramid.to_level({k.u, k.v}, k.level);
    const Keypoint& candidate = right.keypoints[std::size_t(partners[i])];
    const Eigen::Vector2f start = right_pyramid.to_level({candidate.u, candidate.v}, k.level);
    const Refined refined = refine(
        left_pyramid.level(k.level), right_pyramid.level(k.level), static_cast<int>(std::lround(at.x())),
        static_cast<int>(std::lround(at.y())), static_cast<int>(std::lround(start.x())));
    if (!refined.valid) continue;
    // The patch is that around the whole pixel, the corner sits a fraction beside it: both see the same
    // disparity.
    const float disparity = (std::round(at.x()) - refined.x) * left_pyramid.scale_x(k.level);
    const float u_right = k.u - disparity;
    if (disparity <= std::max(0.0, camera.disparity_offset) || disparity > max_disparity || u_right < 0.0F)
      continue;
    matches.u_right[i] = u_right;
    matches.depth[i] = static_cast<float>(camera.depth_from_disparity(disparity));
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
