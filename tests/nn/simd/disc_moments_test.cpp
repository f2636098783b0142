#include "nn/simd/kernel_table.h"
#include "tests/support/image_cases.h"

namespace penumbra::nn {
namespace {

class DiscMoments : public test::EveryIsa {};

TEST_P(DiscMoments, AreThoseOfThePixelsInTheDisc) {
  DiscWeights weights;
  const auto is_inside = [](int x, int y) { return x * x + y * y <= kDiscRadius * kDiscRadius; };
  for (int y = -kDiscRadius; y <= kDiscRadius; ++y) {
    for (int x = -kDiscRadius; x <= kDiscRadius; ++x) {
      if (!is_inside(x, y)) continue;
      weights.one[y + kDiscRadius][x + kDiscRadius] = 1;
      weights.column[y + kDiscRadius][x + kDiscRadius] = static_cast<std::int8_t>(x);
    }
  }
  for (const ByteImage& image :
       {test::noise_image(40, 40), test::extreme_image(40, 40), ByteImage::filled(40, 40, 255)}) {
    int m10 = 0, m01 = 0;
    for (int y = -kDiscRadius; y <= kDiscRadius; ++y) {
      for (int x = -kDiscRadius; x <= kDiscRadius; ++x) {
        if (!is_inside(x, y)) continue;
        m10 += x * image.at(20 + x, 18 + y);
        m01 += y * image.at(20 + x, 18 + y);
      }
    }
    int ours10 = -1, ours01 = -1;
    kernels().image.disc_moments(image.row(18) + 20, image.pitch(), weights, &ours10, &ours01);
    EXPECT_EQ(ours10, m10);
    EXPECT_EQ(ours01, m01);
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, DiscMoments, test::every_isa(), test::isa_name);

}  // namespace
}  // namespace penumbra::nn
