#include "nn/image/blur.h"

#include "nn/image/border.h"
#include "nn/simd/kernel_table.h"

namespace penumbra {

namespace {

constexpr int kBlurRadius = 3;
constexpr std::uint8_t kBlurWeights[kBlurRadius + 1] = {56, 48, 34, 18};  // of 256, by distance

}  // namespace

void GaussianBlur::apply(const ByteView& in, ByteImage& out) {
  out.create(in.width, in.height);
  row_.resize(static_cast<std::size_t>(in.width + 2 * kBlurRadius));
  float* middle = row_.data() + kBlurRadius;
  const nn::ImageKernels& kernels = nn::kernels().image;
  for (int y = 0; y < in.height; ++y) {
    const std::uint8_t* rows[2 * kBlurRadius + 1];
    for (int j = -kBlurRadius; j <= kBlurRadius; ++j)
      rows[j + kBlurRadius] = in.row(mirrored(y + j, in.height));
    kernels.blur_rows(rows, kBlurWeights, in.width, middle);
    for (int i = 1; i <= kBlurRadius; ++i) {
      middle[-i] = middle[mirrored(-i, in.width)];
      middle[in.width - 1 + i] = middle[mirrored(in.width - 1 + i, in.width)];
    }
    kernels.blur_columns(middle, kBlurWeights, in.width, out.row(y));
  }
}

}  // namespace penumbra
