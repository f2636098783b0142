// The names of the activation functions; nn/layers/activations.h says what they are.
#pragma once

namespace penumbra::nn {

// What a layer does after its sums.
enum class Activation { none, relu, leaky_relu, sigmoid, silu, hard_sigmoid, hard_swish };

}  // namespace penumbra::nn
