// Mixed attention: where to look, then at which channels.
//
//   M(F) = M_c( M_s(F) )        spatial attention first, then channel attention      docs/papers.md (1), (2)
//
// Shapes: F [N, C, H, W], in place. Cost: that of spatial_attention.h and channel_attention.h.
// Source: docs/papers.md A.1; reference/attention.cpp is the oracle.
#pragma once

#include <utility>

#include "nn/layers/channel_attention.h"
#include "nn/layers/spatial_attention.h"

namespace penumbra::nn {

class MixedAttention {
 public:
  MixedAttention() = default;
  MixedAttention(SpatialAttention spatial, ChannelAttention channel)
      : spatial_(std::move(spatial)), channel_(std::move(channel)) {}

  // F <- M(F)
  void apply(FeatureMap& map, Arena& arena) const {
    spatial_.apply(map, arena);
    channel_.apply(map, arena);
  }

 private:
  SpatialAttention spatial_;
  ChannelAttention channel_;
};

}  // namespace penumbra::nn
