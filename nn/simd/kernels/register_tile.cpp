// The register tile of 32-bit floating-point numbers.

#include "nn/simd/kernels/register_tile.h"

#include "nn/simd/kernels/kernels.h"
#if defined(PENUMBRA_NEON)
#include "nn/simd/kernels/neon_steps.h"
#endif

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

struct Float32
#if defined(PENUMBRA_NEON)
    : NumberOfLanes<Float32>
#endif
{
  using Element = float;
  using Sum = Vector;
  using Group = Vector;
  using Weights = Vector;
  static constexpr int kGroup = 1;

  __attribute__((always_inline)) static Vector zero() { return Vector(0.0F); }
  __attribute__((always_inline)) static Vector load(const float* w) { return Vector::load_aligned(w); }
  __attribute__((always_inline)) static Vector finish(const Vector& sum, const TileArguments&, int) {
    return sum;
  }
#if defined(PENUMBRA_NEON)
  __attribute__((always_inline)) static float32x4_t load_pixel(const float* x) { return vld1q_f32(x); }
  template <int lane>
  __attribute__((always_inline)) static Vector multiply(float32x4_t x, const Vector& w, const Vector& sum) {
    return vfmaq_laneq_f32(sum, w, x, lane);
  }
#else
  static constexpr bool kPairs = false, kOwnSteps = false;
  __attribute__((always_inline)) static Vector broadcast(const float* x) { return Vector(*x); }
  __attribute__((always_inline)) static Vector multiply(const Vector& x, const Vector& w, const Vector& sum) {
    return madd(x, w, sum);
  }
#endif
};

}  // namespace

extern const TileKernels kRegisterTile;
constexpr TileKernels kRegisterTile = register_tile<Float32>();

}  // namespace penumbra::nn::PENUMBRA_ISA
