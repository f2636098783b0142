#include "nn/simd/tile_unit.h"

#include "nn/simd/isa.h"
#include "nn/simd/low_precision.h"

namespace penumbra::nn {

const TileUnit* tile_unit() {
#if defined(__x86_64__)
  switch (current_isa()) {
    case Isa::amx:
      return &amx::kTileUnit;
    case Isa::amx_emulated:
      return &amx_emulated::kTileUnit;
    default:
      break;
  }
#endif
  return nullptr;
}

const LineKernels* line_kernels() {
  if (const TileUnit* unit = tile_unit()) return &unit->lines;
#if defined(__x86_64__)
  // They are compiled with those of the tile unit, for AVX-512.
  if (is_supported(Precision::bf16)) return &amx::kTileUnit.lines;
#endif
  return nullptr;
}

}  // namespace penumbra::nn
