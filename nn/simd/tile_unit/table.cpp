#include "nn/simd/tile_unit/unit.h"

namespace penumbra::nn::PENUMBRA_ISA {

extern const TileUnit kTileUnit;
const TileUnit kTileUnit = {multiply,
                            {convert_lines, split_pixels, add_lines, max_line, roi_align_lines, dot_lines},
                            tile_product,
                            peak_loop};

}  // namespace penumbra::nn::PENUMBRA_ISA
