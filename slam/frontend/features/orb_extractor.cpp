#include "slam/frontend/features/orb_extractor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>

#include "nn/simd/kernel_table.h"
#include "slam/frontend/features/orb_pattern.h"

namespace penumbra::slam {

namespace {

constexpr int kBorder = kPatchRadius + 1;  // no corner is closer to the level's border than this

static_assert(kPatchRadius == nn::kDiscRadius);

const nn::DiscWeights& disc_weights() {
  static const nn::DiscWeights weights = [] {
    nn::DiscWeights w;
    for (int y = -kPatchRadius; y <= kPatchRadius; ++y) {
      const int half = static_cast<int>(std::sqrt(static_cast<double>(kPatchRadius * kPatchRadius - y * y)));
      for (int x = -half; x <= half; ++x) {
        w.one[y + kPatchRadius][x + kPatchRadius] = 1;
        w.column[y + kPatchRadius][x + kPatchRadius] = static_cast<std::int8_t>(x);
      }
    }
    return w;
  }();
  return weights;
}

// Direction from the disc's centre to its centre of intensity. kBorder leaves the pixel more to the right.
float orientation(const ByteView& image, int x, int y) {
  int m10 = 0, m01 = 0;
  nn::kernels().image.disc_moments(image.row(y) + x, image.pitch, disc_weights(), &m10, &m01);
  return std::atan2(static_cast<float>(m01), static_cast<float>(m10));
}

// kBorder leaves the pixel more to the right that a row of kPatchStride has.
Descriptor describe(const ByteView& blurred, int x, int y, float angle) {
  std::array<std::uint8_t, std::size_t(kPatchRows) * kPatchStride> patch;
  for (int j = 0; j < kPatchRows; ++j) {
    const std::uint8_t* row = blurred.row(y + j - kPatchRadius) + x - kPatchRadius;
    std::memcpy(patch.data() + j * kPatchStride, row, kPatchStride);
  }
  const OrbPattern::Places& places = OrbPattern::get().places(angle);
  Descriptor descriptor;
  for (std::size_t word = 0; word < descriptor.size(); ++word) {
    std::uint64_t bits = 0;
    for (std::size_t i = 64 * word + 64; i-- > 64 * word;)
      bits = 2 * bits + (patch[places.a[i]] < patch[places.b[i]]);
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

int default_feature_count(const Size& image) {
  constexpr double kPixelsPerFeature = 1241.0 * 376.0 / 2000.0;
  return std::clamp(static_cast<int>(static_cast<double>(image.width) * image.height / kPixelsPerFeature),
                    1000, 4000);
}

void OrbExtractor::find_corners(const ByteView& level, const Rect& region) {
  fast_.measure(level, region, std::min(settings_.fast_threshold, settings_.lowest_fast_threshold));
  corners_.clear();
  fast_.find(region, settings_.fast_threshold, corners_);

  const int size = settings_.cell_size;
  const int columns = (region.width + size - 1) / size, rows = (region.height + size - 1) / size;
  cell_has_corner_.assign(static_cast<std::size_t>(columns * rows), 0);
  for (const Corner& corner : corners_) {
    const int column = (corner.x - region.x) / size, row = (corner.y - region.y) / size;
    cell_has_corner_[static_cast<std::size_t>(row * columns + column)] = 1;
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (cell_has_corner_[static_cast<std::size_t>(row * columns + column)]) continue;
      const Rect cell{region.x + column * size, region.y + row * size, size, size};
      fast_.find(intersection(cell, region), settings_.lowest_fast_threshold, corners_);
    }
  }
}

void OrbExtractor::extract(const ByteImage& grey, Features& features, double more) {
  features.clear();
  pyramid_.build(grey, settings_.pyramid, 2 * kBorder + 1);
  const int wanted = settings_.features > 0 ? settings_.features : default_feature_count(grey.size());
  const std::vector<int> counts =
      features_per_level(static_cast<int>(std::lround(more * wanted)), level_scales(settings_.pyramid));

  // A keyframe keeps them: no more than there are.
  const auto most = static_cast<std::size_t>(std::accumulate(counts.begin(), counts.end(), 0));
  features.keypoints.reserve(most);
  features.descriptors.reserve(most);

  for (int l = 0; l < pyramid_.levels(); ++l) {
    const ByteView level = pyramid_.level(l);
    const Rect region{kBorder, kBorder, level.width - 2 * kBorder, level.height - 2 * kBorder};
    find_corners(level, region);
    const std::vector<Corner>& spread =
        spreader_.spread(corners_, region, counts[static_cast<std::size_t>(l)]);
    if (spread.empty()) continue;
    blur_.apply(level, blurred_);
    for (const Corner& corner : spread) {
      const Eigen::Vector2f at(static_cast<float>(corner.x), static_cast<float>(corner.y));
      const Eigen::Vector2f full = pyramid_.to_full(at, l);
      const float angle = orientation(level, corner.x, corner.y);
      features.keypoints.push_back({full.x(), full.y(), l, angle, static_cast<float>(corner.score)});
      features.descriptors.push_back(describe(blurred_, corner.x, corner.y, angle));
    }
  }
}

}  // namespace penumbra::slam
