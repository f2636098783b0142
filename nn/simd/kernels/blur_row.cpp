// The two halves of the blur: seven rows are mixed in 16-bit numbers, then seven columns in 32-bit floats,
// which hold the whole numbers below 2^24 that come here exactly and multiply and add them in one
// instruction.
#include "nn/simd/kernels/kernels.h"

namespace penumbra::nn::PENUMBRA_ISA {

void blur_rows(const std::uint8_t* const* rows, const std::uint8_t* weights, int width, float* out) {
  const std::uint8_t *r0 = rows[0], *r1 = rows[1], *r2 = rows[2], *r3 = rows[3], *r4 = rows[4], *r5 = rows[5],
                     *r6 = rows[6];
  const std::uint16_t v0 = weights[0], v1 = weights[1], v2 = weights[2], v3 = weights[3];
  float* __restrict to = out;
  for (int x = 0; x < width; ++x) {
    const auto sum = static_cast<std::uint16_t>(v0 * r3[x] + v1 * (r2[x] + r4[x]) + v2 * (r1[x] + r5[x]) +
                                                v3 * (r0[x] + r6[x]));
    to[x] = static_cast<float>(sum);
  }
}

void blur_columns(const float* columns, const std::uint8_t* weights, int width, std::uint8_t* out) {
  const float w0 = weights[0], w1 = weights[1], w2 = weights[2], w3 = weights[3];
  std::uint8_t* __restrict to = out;
  for (int x = 0; x < width; ++x) {
    const float* m = columns + x;
    const float sum = 32768.0F + w0 * m[0] + w1 * (m[-1] + m[1]) + w2 * (m[-2] + m[2]) + w3 * (m[-3] + m[3]);
    to[x] = static_cast<std::uint8_t>(static_cast<int>(sum * (1.0F / 65536.0F)));
  }
}

}  // namespace penumbra::nn::PENUMBRA_ISA
