#include "slam/frontend/features/orb_extractor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "slam/frontend/features/orb_pattern.h"
#include "slam/frontend/features/quadtree.h"

namespace penumbra::slam {

namespace {

constexpr int kFastRadius = 3;             // FAST looks at a circle of this radius
constexpr int kBorder = kPatchRadius + 1;  // no corner is closer to the level's border than this
constexpr double kBlurSigma = 2.0;         // pixels of the level

// Half width of the disc of radius kPatchRadius in row y.
const std::array<int, kPatchRadius + 1>& disc_rows() {
  static const std::array<int, kPatchRadius + 1> rows = [] {
    std::array<int, kPatchRadius + 1> r{};
    for (int y = 0; y <= kPatchRadius; ++y) {
      r[static_cast<std::size_t>(y)] =
          static_cast<int>(std::sqrt(static_cast<double>(kPatchRadius * kPatchRadius - y * y)));
    }
    return r;
  }();
  return rows;
}

// Direction from the disc's centre to its centre of intensity.
float orientation(const cv::Mat& image, int x, int y) {
  int m01 = 0, m10 = 0;
  const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(image.step);
  const uchar* centre = image.ptr<uchar>(y) + x;
  for (int i = -kPatchRadius; i <= kPatchRadius; ++i) m10 += i * centre[i];
  for (int row = 1; row <= kPatchRadius; ++row) {
    const int half = disc_rows()[static_cast<std::size_t>(row)];
    const uchar* below = centre + row * step;
    const uchar* above = centre - row * step;
    int difference = 0;
    for (int i = -half; i <= half; ++i) {
      difference += below[i] - above[i];
      m10 += i * (below[i] + above[i]);
    }
    m01 += row * difference;
  }
  return std::atan2(static_cast<float>(m01), static_cast<float>(m10));
}

Descriptor describe(const cv::Mat& blurred, int x, int y, float angle) {
  const OrbPattern::Tests& tests = OrbPattern::get().rotated(angle);
  const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(blurred.step);
  const uchar* centre = blurred.ptr<uchar>(y) + x;
  Descriptor descriptor{};
  for (std::size_t word = 0; word < descriptor.size(); ++word) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < 64; ++i) {
      const BinaryTest& t = tests[64 * word + i];
      const bool less = centre[t.ay * step + t.ax] < centre[t.by * step + t.bx];
      bits |= static_cast<std::uint64_t>(less) << i;
    }
    descriptor[word] = bits;
  }
  return descriptor;
}

// How many of `total` features each level gets; the sum is `total`.
std::vector<int> features_per_level(int total, const std::vector<double>& scales) {
  double weight_sum = 0.0;
  for (const double s : scales) weight_sum += 1.0 / s;
  std::vector<int> counts;
  int assigned = 0;
  for (const double s : scales) {
    counts.push_back(static_cast<int>(std::lround(total / s / weight_sum)));
    assigned += counts.back();
  }
  if (!counts.empty()) counts.front() += total - assigned;
  return counts;
}

}  // namespace

int default_feature_count(cv::Size image) {
  constexpr double kPixelsPerFeature = 1241.0 * 376.0 / 2000.0;
  return std::clamp(static_cast<int>(static_cast<double>(image.area()) / kPixelsPerFeature), 1000, 4000);
}

void OrbExtractor::find_corners(const cv::Mat& level, const cv::Rect& region) {
  const auto fast = [&](const cv::Rect& where, int threshold, std::vector<cv::KeyPoint>& found) {
    const cv::Rect seen(where.x - kFastRadius, where.y - kFastRadius, where.width + 2 * kFastRadius,
                        where.height + 2 * kFastRadius);
    cv::FAST(level(seen), found, threshold, true);
    for (cv::KeyPoint& corner : found) corner.pt += cv::Point2f(cv::Point(seen.tl()));
  };
  fast(region, settings_.fast_threshold, corners_);

  const int size = settings_.cell_size;
  const int columns = (region.width + size - 1) / size, rows = (region.height + size - 1) / size;
  cell_has_corner_.assign(static_cast<std::size_t>(columns * rows), 0);
  for (const cv::KeyPoint& corner : corners_) {
    const int column = (static_cast<int>(corner.pt.x) - region.x) / size;
    const int row = (static_cast<int>(corner.pt.y) - region.y) / size;
    cell_has_corner_[static_cast<std::size_t>(row * columns + column)] = 1;
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (cell_has_corner_[static_cast<std::size_t>(row * columns + column)]) continue;
      const cv::Rect cell = cv::Rect(region.x + column * size, region.y + row * size, size, size) & region;
      fast(cell, settings_.lowest_fast_threshold, cell_corners_);
      corners_.insert(corners_.end(), cell_corners_.begin(), cell_corners_.end());
    }
  }
}

void OrbExtractor::extract(const cv::Mat& grey, Features& features, double more) {
  features.clear();
  pyramid_.build(grey, settings_.pyramid, 2 * kBorder + 1);
  const int wanted = settings_.features > 0 ? settings_.features : default_feature_count(grey.size());
  const std::vector<int> counts =
      features_per_level(static_cast<int>(std::lround(more * wanted)), level_scales(settings_.pyramid));

  for (int l = 0; l < pyramid_.levels(); ++l) {
    const cv::Mat& level = pyramid_.level(l);
    const cv::Rect region(kBorder, kBorder, level.cols - 2 * kBorder, level.rows - 2 * kBorder);
    find_corners(level, region);
    const std::vector<cv::KeyPoint> spread =
        spread_corners(corners_, cv::Rect2f(region), counts[static_cast<std::size_t>(l)]);
    if (spread.empty()) continue;
    cv::GaussianBlur(level, blurred_, cv::Size(7, 7), kBlurSigma, kBlurSigma, cv::BORDER_REFLECT_101);
    for (const cv::KeyPoint& corner : spread) {
      const int x = static_cast<int>(corner.pt.x), y = static_cast<int>(corner.pt.y);
      const Eigen::Vector2f full = pyramid_.to_full({corner.pt.x, corner.pt.y}, l);
      const float angle = orientation(level, x, y);
      features.keypoints.push_back({full.x(), full.y(), l, angle, corner.response});
      features.descriptors.push_back(describe(blurred_, x, y, angle));
    }
  }
}

}  // namespace penumbra::slam
