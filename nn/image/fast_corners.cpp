#include "nn/image/fast_corners.h"

#include <algorithm>

#include "nn/image/set_bytes.h"
#include "nn/simd/kernel_table.h"

namespace penumbra {

namespace {

void clear_frame(ByteImage& image) {
  std::fill_n(image.row(0), image.width(), std::uint8_t{0});
  std::fill_n(image.row(image.height() - 1), image.width(), std::uint8_t{0});
  for (int y = 0; y < image.height(); ++y) image.at(0, y) = image.at(image.width() - 1, y) = 0;
}

// Calls visit(x) for every byte of a row that is not 0.
template <typename Visit>
void for_each_set(const std::uint8_t* row, int width, Visit&& visit) {
  for (int x = next_set_byte(row, 0, width); x < width; x = next_set_byte(row, x + 1, width)) visit(x);
}

}  // namespace

void FastCorners::measure(const ByteView& image, const Rect& region, int threshold) {
  region_ = region;
  scores_.create(region.width + 2, region.height + 2);
  clear_frame(scores_);
  const auto score_row = nn::kernels().image.fast_scores;
  for (int y = 0; y < region.height; ++y) {
    score_row(image.row(region.y + y) + region.x, image.pitch, region.width, threshold,
              scores_.row(y + 1) + 1);
  }
}

void FastCorners::find(const Rect& where, int threshold, std::vector<Corner>& corners) {
  if (where == region_) {
    find_everywhere(threshold, corners);
  } else {
    find_in_part(where, threshold, corners);
  }
}

void FastCorners::find_everywhere(int threshold, std::vector<Corner>& corners) {
  const auto find_peaks = nn::kernels().image.peaks;
  is_peak_.resize(static_cast<std::size_t>(region_.width));
  for (int y = 0; y < region_.height; ++y) {
    const std::uint8_t* here = scores_.row(y + 1) + 1;
    const std::ptrdiff_t pitch = scores_.pitch();
    find_peaks(here - pitch, here, here + pitch, region_.width, threshold, is_peak_.data());
    for_each_set(is_peak_.data(), region_.width, [&](int x) {
      corners.push_back({region_.x + x, region_.y + y, here[x]});
    });
  }
}

// A part is looked at where nothing stands out: few of its pixels have a score at all.
void FastCorners::find_in_part(const Rect& where, int threshold, std::vector<Corner>& corners) {
  const ByteView scores =
      scores_.view().region({where.x - region_.x + 1, where.y - region_.y + 1, where.width, where.height});
  for (int y = 0; y < where.height; ++y) {
    const std::uint8_t* here = scores.row(y);
    const int first = std::max(y - 1, 0), last = std::min(y + 1, where.height - 1);
    for_each_set(here, where.width, [&](int x) {
      if (here[x] < threshold) return;
      for (int j = first; j <= last; ++j) {
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, where.width - 1); ++i) {
          if ((i != x || j != y) && scores.at(i, j) >= here[x]) return;
        }
      }
      corners.push_back({where.x + x, where.y + y, here[x]});
    });
  }
}

}  // namespace penumbra
