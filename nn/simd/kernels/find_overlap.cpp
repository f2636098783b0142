// Boxes that may overlap one: kernel_table.h says what it computes.

#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/vector.h"

namespace penumbra::nn::PENUMBRA_ISA {

int find_overlap(const FindOverlapArguments& a) {
  constexpr float kCautious = 1.0F - 1e-5F;
  const Vector x1(a.x1), y1(a.y1), x2(a.x2), y2(a.y2), area(a.area), zero(0.0F);
  const Vector threshold(a.threshold * kCautious);
  for (int k = a.first; k >= 0; k = a.lanes[k].before) {
    const BoxLanes& b = a.lanes[k];
    for (int l = 0; l < kBoxLanes; l += kLanes) {
      const Vector width =
          min(Vector::load_unaligned(b.x2 + l), x2) - max(Vector::load_unaligned(b.x1 + l), x1);
      const Vector height =
          min(Vector::load_unaligned(b.y2 + l), y2) - max(Vector::load_unaligned(b.y1 + l), y1);
      const Vector both = max(width, zero) * max(height, zero);
      // both / all > threshold without a division; where `area` is NaN, so is this.
      const Vector all = Vector::load_unaligned(b.area + l) + area - both;
      if (any(both > threshold * all)) return k;
    }
  }
  return -1;
}

}  // namespace penumbra::nn::PENUMBRA_ISA
