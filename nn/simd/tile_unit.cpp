#include "nn/simd/tile_unit.h"

#include "nn/simd/isa.h"

namespace penumbra::nn {

const TileUnit* tile_unit() {
  switch (current_isa()) {
    case Isa::amx:
      return &amx::kTileUnit;
    case Isa::amx_emulated:
      return &amx_emulated::kTileUnit;
    case Isa::avx512:
    case Isa::avx2:
    case Isa::baseline:
      break;
  }
  return nullptr;
}

}  // namespace penumbra::nn
