#include "nn/image/grey.h"

#include <cmath>

#include "nn/image/border.h"
#include "nn/simd/kernel_table.h"

namespace penumbra {

ByteImage to_grey(const ByteImage& image) {
  if (image.channels() == 1) return image;
  ByteImage grey(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y)
    nn::kernels().image.grey_row(image.row(y), image.width(), grey.row(y));
  return grey;
}

double slope_energy(const ByteView& grey, double threshold) {
  constexpr double kSums = 64.0;  // the square of what Sobel's sums are of a slope
  const int least = static_cast<int>(std::floor(std::min(threshold * kSums, 1e9)));
  std::uint64_t sum = 0;
  for (int y = 0; y < grey.height; ++y) {
    const std::uint8_t *above = grey.row(mirrored(y - 1, grey.height)), *here = grey.row(y),
                       *below = grey.row(mirrored(y + 1, grey.height));
    const auto energy = [&](const std::uint8_t* a, const std::uint8_t* h, const std::uint8_t* b, int count) {
      return nn::kernels().image.slope_energy(a, h, b, count, least);
    };
    if (grey.width > 2) sum += energy(above + 1, here + 1, below + 1, grey.width - 2);
    for (int x = 0; x < grey.width; x += std::max(1, grey.width - 1)) {
      const int left = mirrored(x - 1, grey.width), right = mirrored(x + 1, grey.width);
      const std::uint8_t a[3] = {above[left], above[x], above[right]},
                         h[3] = {here[left], here[x], here[right]},
                         b[3] = {below[left], below[x], below[right]};
      sum += energy(a + 1, h + 1, b + 1, 1);
    }
  }
  return static_cast<double>(sum) / kSums;
}

}  // namespace penumbra
