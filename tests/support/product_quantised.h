// Product-quantised weights made plain: a layer's tensor is a list of sub-vectors, stored as numbers into a
// codebook.
#pragma once

#include "nn/io/state_dict.h"

namespace penumbra::test {

// The ResNet-50 that `quantised` holds, by torchvision's names:
//   NAME.codes_matrix (whole numbers) and NAME.codebook [K, d]  ->  NAME.weight = codebook[codes],
//   row after row
// and running means of 0 and variances of 1 for the batch norms, which the file leaves out.
nn::StateDict decode_product_quantised(const nn::StateDict& quantised);

}  // namespace penumbra::test
