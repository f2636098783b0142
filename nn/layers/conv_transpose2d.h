// Transposed convolution: every input pixel adds its multiple of the kernel to the output.
//
//   y[n, o, i s - p + u d, j s - p + v d] += sum_c w[c, o, u, v] x[n, c, i, j],  then  y = act(y + b[o])
//   H_out = (H - 1) s - 2 p + d (K - 1) + output_padding + 1, the same for W
//   stride s, padding p, dilation d
//
// Shapes: x [N, C, H, W], w [C, O, K_h, K_w], y [N, O, H_out, W_out].
// Cost: N O C K_h K_w H W multiply-adds (C rounded up to 16).
// Method: output row i meets the kernel rows u with i + p - u d divisible by s, and so does every s-th row
// from there. The s^2 phases (i mod s, j mod s) of the output thus are s^2 convolutions of stride 1, each
// with its part of the kernel, on the register-tile kernel; with K = s, as in the mask head, a phase has one
// kernel position. x's border serves as the zeros around it (a copy is made where it is too narrow). The
// result does not depend on the number of threads.
// Source: torch.nn.ConvTranspose2d; Dumoulin and Visin 2016, A guide to convolution arithmetic, chapter 4;
// reference/convolution.cpp is the oracle.
#pragma once

#include <cstddef>
#include <vector>

#include "nn/layers/activations.h"
#include "nn/layers/packed_weights.h"
#include "nn/tensor/feature_map.h"
#include "nn/tensor/tensor.h"

namespace penumbra::nn {

struct ConvTranspose2dOptions {
  int stride = 1;
  int padding = 0;         // pixels cut from every side of the output
  int output_padding = 0;  // rows and columns added below and to the right; less than stride or dilation
  int dilation = 1;
  Activation activation = Activation::none;
  float slope = kDefaultSlope;  // of leaky_relu
  NumberFormat format;          // of the products
};

class ConvTranspose2d {
 public:
  ConvTranspose2d() = default;
  // Throws InputError where the weight is not [C, O, K_h, K_w], the bias is not one value an output channel
  // or an option is out of range.
  ConvTranspose2d(const Tensor& weight, const std::vector<float>& bias, ConvTranspose2dOptions options);

  // The output is stored in `output_numbers`: on a tile unit any, else f32.
  FeatureMap operator()(const FeatureMap& input, Arena& arena, int output_border = 0,
                        const Numbers& output_numbers = {}) const;

  // In what the map that it reads is best stored: f32 but on a tile unit.
  Numbers input_numbers() const { return on_tiles_ ? numbers_of(options_.format) : Numbers{}; }

 private:
  struct Offset {
    int y, x;  // from the output pixel's own input pixel (i div s, j div s)
  };
  // The output pixels whose row is `row` and whose column is `column` modulo the stride.
  struct Phase {
    int row, column;
    std::vector<Offset> offsets;  // one a kernel position that they meet
    PackedWeights weights;        // taps: positions within input blocks
  };

  // `values` are the input's in the layer's precision.
  void run_phase(const Phase& phase, const FeatureMap& input, const std::byte* values, std::ptrdiff_t* taps,
                 FeatureMap& output, Arena& arena) const;

  ConvTranspose2dOptions options_;
  int input_channels_ = 0, outputs_ = 0, kernel_height_ = 0, kernel_width_ = 0;
  bool on_tiles_ = false;
  std::vector<Phase> phases_;
};

}  // namespace penumbra::nn
