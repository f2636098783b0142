// The register tile of 32-bit floating-point numbers.

#include "nn/simd/kernels/register_tile.h"

#include "nn/simd/kernels/kernels.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

struct Float32 {
  using Element = float;
  using Sum = Vector;
  using Group = Vector;
  using Weights = Vector;
  static constexpr int kGroup = 1;

  __attribute__((always_inline)) static Vector zero() { return Vector(0.0F); }
  __attribute__((always_inline)) static Vector load(const float* w) { return Vector::load_aligned(w); }
  __attribute__((always_inline)) static Vector broadcast(const float* x) { return Vector(*x); }
  __attribute__((always_inline)) static Vector multiply(const Vector& x, const Vector& w, const Vector& sum) {
    return madd(x, w, sum);
  }
  __attribute__((always_inline)) static Vector finish(const Vector& sum, const TileArguments&, int) {
    return sum;
  }
};

}  // namespace

extern const TileKernels kRegisterTile;
constexpr TileKernels kRegisterTile = register_tile<Float32>();

}  // namespace penumbra::nn::PENUMBRA_ISA
