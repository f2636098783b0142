#include "nn/image/fast_corners.h"

#include <cstring>

#include "nn/simd/kernel_table.h"

namespace penumbra {

namespace {

void clear_frame(ByteImage& image) {
  std::fill_n(image.row(0), image.width(), std::uint8_t{0});
  std::fill_n(image.row(image.height() - 1), image.width(), std::uint8_t{0});
  for (int y = 0; y < image.height(); ++y) image.at(0, y) = image.at(image.width() - 1, y) = 0;
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
  ByteView scores = scores_.view();
  if (!(where == region_)) {
    part_.create(where.width + 2, where.height + 2);
    clear_frame(part_);
    for (int y = 0; y < where.height; ++y) {
      std::copy_n(scores_.row(where.y - region_.y + y + 1) + where.x - region_.x + 1, where.width,
                  part_.row(y + 1) + 1);
    }
    scores = part_.view();
  }
  const auto find_peaks = nn::kernels().image.peaks;
  constexpr int kWord = 8;  // marks that are looked at together: most are 0
  is_peak_.resize(static_cast<std::size_t>(where.width + kWord));
  std::fill(is_peak_.end() - kWord, is_peak_.end(), std::uint8_t{0});
  for (int y = 0; y < where.height; ++y) {
    const std::uint8_t* here = scores.row(y + 1) + 1;
    find_peaks(here - scores.pitch, here, here + scores.pitch, where.width, threshold, is_peak_.data());
    for (int begin = 0; begin < where.width; begin += kWord) {
      std::uint64_t marks;
      std::memcpy(&marks, is_peak_.data() + begin, sizeof marks);
      if (marks == 0) continue;
      for (int x = begin; x < begin + kWord; ++x) {
        if (is_peak_[static_cast<std::size_t>(x)] != 0)
          corners.push_back({where.x + x, where.y + y, here[x]});
      }
    }
  }
}

}  // namespace penumbra
