// In which numbers the layers of a network multiply, and how 8-bit ones come to know their inputs' range.
//
// Every layer that asks for a format gets the network's precision; stems, the layers whose results are read
// as numbers (class logits, box deltas, mask logits) and attention do not ask and stay f32. For int8 the
// weights' metadata must hold the range of each layer's inputs, as `penumbra calibrate` writes it:
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

  // Throws InputError where int8 lacks a range or has a wrong one, UsageError where this machine cannot.
  NumberFormat format(const StateDict& weights, const std::string& layer) const;
};

// Writes the ranges into the metadata.
void store_input_ranges(const InputRanges& ranges, StateDict& weights);

}  // namespace penumbra::nn
