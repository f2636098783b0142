// What the processor can do at best: multiply-adds that never leave the registers.

#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/vector.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

// Two multiply-adds a cycle, each of which takes four or five: ten independent sums keep both units busy. All
// loops over them are unrolled, else they would live in memory.
constexpr int kSums = 12;

}  // namespace

double peak_loop(long iterations) {
  Vector sum[kSums];
  // Each starts with a number of its own, else the compiler would compute one sum for all.
#pragma GCC unroll 12
  for (int i = 0; i < kSums; ++i) sum[i] = Vector(1.0F + static_cast<float>(i));
  Vector a(0.999F), b(1e-3F);
  for (long i = 0; i < iterations; ++i) {
    // Else the compiler would fold the loop away.
    forget(a);
    forget(b);
#pragma GCC unroll 12
    for (auto& s : sum) s = madd(s, a, b);
  }
  Vector total(0.0F);
#pragma GCC unroll 12
  for (const auto& s : sum) total += s;
  volatile float keep = total.get(0);
  static_cast<void>(keep);
  return 2.0 * static_cast<double>(iterations) * kSums * kLanes;
}

}  // namespace penumbra::nn::PENUMBRA_ISA
