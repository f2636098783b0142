// One block of 16 channels of a region of RoIAlign: kernel_table.h says what it computes.

#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/vector.h"

namespace penumbra::nn::PENUMBRA_ISA {

void roi_align(const RoiAlignArguments& a) {
  const int samples = a.row_sampling * a.column_sampling;
  const Vector share(samples > 0 ? 1.0F / static_cast<float>(samples) : 1.0F);
  for (int i = 0; i < a.size; ++i) {
    for (int j = 0; j < a.size; ++j) {
      Vector sum[kBlockVectors];
      for (auto& s : sum) s = Vector(0.0F);
      for (int u = 0; u < a.row_sampling; ++u) {
        const AxisSample& row = a.rows[i * a.row_sampling + u];
        const float* upper = a.map + row.low * a.map_row_stride;
        const float* lower = a.map + row.high * a.map_row_stride;
        for (int v = 0; v < a.column_sampling; ++v) {
          const AxisSample& column = a.columns[j * a.column_sampling + v];
          const int left = column.low * kBlockLanes, right = column.high * kBlockLanes;
          const Vector w00(row.low_weight * column.low_weight), w01(row.low_weight * column.high_weight);
          const Vector w10(row.high_weight * column.low_weight), w11(row.high_weight * column.high_weight);
          for (int k = 0; k < kBlockVectors; ++k) {
            const int c = k * kLanes;
            sum[k] = madd(w00, Vector::load_unaligned(upper + left + c), sum[k]);
            sum[k] = madd(w01, Vector::load_unaligned(upper + right + c), sum[k]);
            sum[k] = madd(w10, Vector::load_unaligned(lower + left + c), sum[k]);
            sum[k] = madd(w11, Vector::load_unaligned(lower + right + c), sum[k]);
          }
        }
      }
      float* out = a.output + i * a.output_row_stride + j * kBlockLanes;
      for (int k = 0; k < kBlockVectors; ++k) (sum[k] * share).store_unaligned(out + k * kLanes);
    }
  }
}

}  // namespace penumbra::nn::PENUMBRA_ISA
