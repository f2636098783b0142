#include "nn/simd/tile_unit.h"

#include "nn/simd/isa.h"

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

}  // namespace penumbra::nn
