// In which numbers the layers of a network multiply, and how 8-bit ones come to know their inputs' range.
//
// Every layer that asks for a format gets the network's precision. Stems and the layers whose results are
// read as numbers (class logits, box deltas) ask for an uncalibrated one: f32, but on a tile unit, where f32
// would cost more than all the others, bf16 (which Conv2d makes two bf16 a number for stems). Attention and
// mask logits (which read bf16 on a tile unit) do not ask and stay f32. For int8 the weights' metadata must
// hold the range of each layer's inputs, as `penumbra calibrate` writes it:
//
//   input_range.NAME    "LOW,HIGH": averages over images of a layer's least and greatest input
//
// See docs/engine/quantisation.md.
#pragma once

#include <map>
#include <string>

#include "nn/io/state_dict.h"
#include "nn/layers/number_format.h"

namespace penumbra::nn {

using InputRanges = std::map<std::string, InputRange>;  // by layer

struct LayerPrecision {
  Precision precision = Precision::f32;
  InputRanges* observed = nullptr;  // where not null, the layers note their inputs here while they run
  bool automatic = false;           // `precision` is left to resolved()

  // What the layers take: f32 for bf16 where that would be slower (low_precision.h). Of `automatic` the
  // fastest of this machine: int8 where it has that and the weights are calibrated for it, else bf16 where it
  // is faster than f32, else f32. Throws UsageError for a precision that this machine has not.
  LayerPrecision resolved(const StateDict& weights) const;

  // Throws InputError where int8 lacks a range or has a wrong one, UsageError where this machine cannot.
  NumberFormat format(const StateDict& weights, const std::string& layer) const;
  NumberFormat uncalibrated_format() const;
};

// Writes the ranges into the metadata.
void store_input_ranges(const InputRanges& ranges, StateDict& weights);

}  // namespace penumbra::nn
