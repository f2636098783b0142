// Sums and products of two maps, the second one broadcast.
//
//   add:       y[n, c, i, j] += x[n', c', i', j']
//   multiply:  y[n, c, i, j] *= x[n', c', i', j']
//
// where an index of x is 0 if x has extent 1 there, else y's. So x may be a whole map, a value a channel
// ([N, C, 1, 1]), a value a pixel ([N, 1, H, W]), a row, a column or a single number.
// Cost: one operation a value; y is read and written once.
// Source: NumPy's and PyTorch's broadcasting; reference/elementwise.cpp is the oracle.
#pragma once

#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

void add(FeatureMap& y, const FeatureMap& x);
void multiply(FeatureMap& y, const FeatureMap& x);

}  // namespace penumbra::nn
