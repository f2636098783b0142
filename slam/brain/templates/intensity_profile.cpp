#include "slam/brain/templates/intensity_profile.h"

#include <cmath>
#include <limits>

#include "nn/base/error.h"

namespace penumbra::slam::brain {

namespace {

// Mean difference at one shift.
float difference_at(const IntensityProfile& a, const IntensityProfile& b, int shift) {
  const int first = std::max(0, -shift), last = std::min(kProfileWidth, kProfileWidth - shift);
  float sum = 0.0F;
  for (int y = 0; y < kProfileHeight; ++y) {
    const float* row_a = a.data() + y * kProfileWidth;
    const float* row_b = b.data() + y * kProfileWidth + shift;
    // Four sums side by side: a vector register's.
    std::array<float, 4> lanes{};
    int x = first;
    for (; x + 4 <= last; x += 4) {
      for (int l = 0; l < 4; ++l) lanes[static_cast<std::size_t>(l)] += std::abs(row_a[x + l] - row_b[x + l]);
    }
    float row = (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
    for (; x < last; ++x) row += std::abs(row_a[x] - row_b[x]);
    sum += row;
  }
  return sum / static_cast<float>((last - first) * kProfileHeight);
}

}  // namespace

IntensityProfile intensity_profile(const ByteView& grey, const ProfileSettings& settings) {
  if (grey.width < kProfileWidth || grey.height < kProfileHeight) {
    throw InputError("image", fmt::format("at least {}x{} pixels", kProfileWidth, kProfileHeight),
                     fmt::format("{}x{}", grey.width, grey.height));
  }
  const double top = settings.upper * grey.height, band = (settings.lower - settings.upper) * grey.height;
  IntensityProfile profile;
  double sum = 0.0, squares = 0.0;
  for (int y = 0; y < kProfileHeight; ++y) {
    const int y0 = static_cast<int>(top + band * y / kProfileHeight);
    const int y1 = std::max(y0 + 1, static_cast<int>(top + band * (y + 1) / kProfileHeight));
    for (int x = 0; x < kProfileWidth; ++x) {
      const int x0 = grey.width * x / kProfileWidth, x1 = grey.width * (x + 1) / kProfileWidth;
      int total = 0;
      for (int v = y0; v < y1; ++v) {
        const std::uint8_t* row = grey.row(v);
        for (int u = x0; u < x1; ++u) total += row[u];
      }
      const double mean = static_cast<double>(total) / ((y1 - y0) * (x1 - x0));
      profile[static_cast<std::size_t>(y * kProfileWidth + x)] = static_cast<float>(mean);
      sum += mean;
      squares += mean * mean;
    }
  }
  const double mean = sum / static_cast<double>(profile.size());
  const double variance = squares / static_cast<double>(profile.size()) - mean * mean;
  // Half a grey level is the images' own quantisation.
  const double scale = variance > 0.25 ? 1.0 / std::sqrt(variance) : 0.0;
  for (float& field : profile) field = static_cast<float>((field - mean) * scale);
  return profile;
}

ProfileDifference compare_profiles(const IntensityProfile& a, const IntensityProfile& b, int largest_shift) {
  ProfileDifference best{std::numeric_limits<float>::max(), 0};
  // From the middle outwards: of equal differences the least shift wins.
  for (int n = 0; n <= 2 * largest_shift; ++n) {
    const int shift = n % 2 == 0 ? n / 2 : -(n + 1) / 2;
    const float difference = difference_at(a, b, shift);
    if (difference < best.difference) best = {difference, shift};
  }
  return best;
}

}  // namespace penumbra::slam::brain
