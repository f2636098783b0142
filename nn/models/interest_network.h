// The interest network: which class each cell of an image shows, and an embedding by which the thing in it is
// known again.
//
//   image -> letterbox -> encoder to stride 8 (E8) and 16 (E16) -> self-attention -> decoder to stride 8
//
//   Conv(x)    = relu(W * x + b)         3 x 3, batch norm folded       Unit(x) = relu(x + W * x + b)
//   E8         = Unit(Unit(Conv_2(Unit(Conv_2(Conv_2(image))))))        Conv_s has stride s
//   E16        = Unit(Conv_2(E8)),   A = E16 + gamma attention(E16)     docs/papers.md (13) to (15)
//   D          = Conv(E8 + up(W_l A + b_l))                             up: nearest, by 2
//   logits     = W_c D + b_c,        embedding = W_e D + b_e            made unit length
//
// The weights decide channels, classes, the embedding's size and whether there is attention; their names are
// encoder.K, coarse.K, attention, lateral, decoder, classes and embedding, with batch norms or without.
// Images larger than about `most_pixels` are made smaller, so that any image takes about the same time.
// Cost: 0.46 G multiply-adds for 620 x 188 with the channels 16, 32, 64, 96 that ship.
// Source: Zhang et al. 2019 (self-attention); docs/brain/interest.md; weights_tools/reference/interest.py is
// the oracle.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "nn/io/letterbox.h"
#include "nn/layers/self_attention.h"
#include "nn/models/layer_precision.h"
#include "nn/models/weight_reader.h"

namespace penumbra::nn {

struct InterestConfig {
  double most_pixels = 120'000.0;  // of the image at the network
  LayerPrecision precision;
};

// What the network says of an image. Cell (x, y) shows the pixels from left + x size, top + y size on.
struct InterestMap {
  int width = 0, height = 0, classes = 0, embedding = 0;
  float left = 0.0F, top = 0.0F, size = 0.0F;  // pixels of the image
  std::vector<float> probabilities;            // cell by cell, row by row: of each class
  std::vector<float> embeddings;               // the same; unit length
};

class InterestNetwork {
 public:
  // Border that the image's feature map should have.
  static constexpr int kImageBorder = 1;

  // Throws InputError that lists every tensor that is missing, mis-shaped or not part of the network.
  explicit InterestNetwork(const StateDict& weights, InterestConfig config = {});

  int classes() const { return classes_.output_channels(); }
  int embedding() const { return embedding_.output_channels(); }
  bool has_attention() const { return attention_.has_value(); }

  // `image` is 8-bit grey or BGR of any size, not empty (else InputError). `map` is overwritten, its memory
  // used again: from the second image of a shape on nothing is allocated. Threads may share the network if
  // each has an arena of its own.
  void operator()(const ByteView& image, Arena& arena, InterestMap& map) const;

  struct Output {
    FeatureMap logits, embedding;
  };
  // The network alone. `image` is [1, 3, H, W] in blocks of 4, extents multiples of 16.
  Output forward(FeatureMap image, Arena& arena) const;
  // Of the convolutions and of the attention, for an image of height x width pixels, multiples of 16.
  double multiply_adds(int height, int width) const;

 private:
  Letterbox letterbox_for(const ByteView& image) const;

  InterestConfig config_;
  Conv2d stem_, down4_, unit4_, down8_, unit8_[2], down16_, unit16_, lateral_, decoder_, classes_, embedding_;
  std::optional<SelfAttention> attention_;
  int coarse_channels_ = 0, attention_width_ = 0;
};

// Whether the tensors' names are those of an interest network.
bool is_interest_network(const StateDict& weights);

}  // namespace penumbra::nn
