// What the layers give for the cases of tests/fixtures/layers: one function a layer.
#pragma once

#include <functional>

#include "nn/tensor/arena.h"
#include "tests/support/layer_cases.h"

namespace penumbra::nn {

// What a layer's fast version and its naive reference give for a case.
struct Outputs {
  Tensor fast, naive;
};
using Layer = std::function<Outputs(const test::LayerCase&, Arena&)>;

// pytorch_region_cases.cpp; the others stand in pytorch_test.cpp.
Outputs roi_align_case(const test::LayerCase& c, Arena& arena);
Outputs multi_scale_roi_align_case(const test::LayerCase& c, Arena& arena);
Outputs nms_case(const test::LayerCase& c, Arena& arena);
Outputs decode_box_case(const test::LayerCase& c, Arena& arena);
Outputs base_anchors_case(const test::LayerCase& c, Arena& arena);
Outputs mask_paste_case(const test::LayerCase& c, Arena& arena);

}  // namespace penumbra::nn
