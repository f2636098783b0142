#include <cstdlib>

#include "nn/simd/kernel_table.h"
#include "tests/support/image_cases.h"

namespace penumbra::nn {
namespace {

class PatchDifferences : public test::EveryIsa {};

int naive_difference(const ByteImage& left, int xl, const ByteImage& right, int xr, int y) {
  int sum = 0;
  for (int dy = -5; dy <= 5; ++dy) {
    for (int dx = -5; dx <= 5; ++dx) {
      sum += std::abs((left.at(xl + dx, y + dy) - left.at(xl, y)) -
                      (right.at(xr + dx, y + dy) - right.at(xr, y)));
    }
  }
  return sum;
}

TEST_P(PatchDifferences, AreThoseOfTheFormula) {
  const auto compare = [](const ByteImage& left, const ByteImage& right) {
    for (int x = 10; x + 10 < left.width(); x += 3) {
      const int xl = x, xr = left.width() - 1 - x, y = 5 + x % (left.height() - 11);
      int sums[kDifferenceSide];
      kernels().image.patch_differences(left.row(y) + xl, left.pitch(), right.row(y) + xr, right.pitch(),
                                        sums);
      for (int s = -5; s <= 5; ++s) ASSERT_EQ(sums[s + 5], naive_difference(left, xl, right, xr + s, y)) << s;
    }
  };
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    compare(test::noise_image(60, 24, 1, seed), test::noise_image(60, 24, 1, seed + 100));
    compare(test::extreme_image(60, 24, 1, seed), test::extreme_image(60, 24, 1, seed + 100));
  }
  ByteImage black = ByteImage::filled(60, 24, 0), white = ByteImage::filled(60, 24, 255);
  compare(black, white);
  for (int y = 0; y < 24; ++y) black.at(30, y) = 255;
  compare(black, white);
}

INSTANTIATE_TEST_SUITE_P(Isa, PatchDifferences, test::every_isa(), test::isa_name);

}  // namespace
}  // namespace penumbra::nn
