#include "nn/models/layer_precision.h"

#include <vector>

#include "nn/base/error.h"
#include "nn/models/weight_metadata.h"
#include "nn/simd/tile_unit.h"

namespace penumbra::nn {

namespace {

const std::string kPrefix = "input_range.";
constexpr double kLargestInput = 1e9;

}  // namespace

NumberFormat LayerPrecision::format(const StateDict& weights, const std::string& layer) const {
  NumberFormat format;
  if (observed != nullptr) format.observed = &(*observed)[layer];
  if (precision == Precision::f32) return format;
  require(precision);
  format.precision = precision;
  if (precision != Precision::int8) return format;
  const std::vector<double> range =
      metadata_numbers(weights, kPrefix + layer, 2, {-kLargestInput, kLargestInput});
  if (range.empty()) {
    throw InputError(weights.source + ", metadata " + kPrefix + layer,
                     "the range of the layer's inputs, as `penumbra calibrate` writes it", "none");
  }
  format.input = quantisation({range[0], range[1], 1});
  return format;
}

LayerPrecision LayerPrecision::resolved(const StateDict& weights) const {
  LayerPrecision result = *this;
  if (automatic) {
    const auto first_range = weights.metadata.lower_bound(kPrefix);
    const bool calibrated = first_range != weights.metadata.end() && first_range->first.starts_with(kPrefix);
    result.automatic = false;
    result.precision = Precision::f32;
    if (is_supported(Precision::bf16)) result.precision = Precision::bf16;
    if (calibrated && is_supported(Precision::int8)) result.precision = Precision::int8;
  }
  const bool slow = result.precision == Precision::bf16 && bf16_arithmetic() == Bf16Arithmetic::f32;
  if (slow) result.precision = Precision::f32;
  return result;
}

NumberFormat LayerPrecision::uncalibrated_format() const {
  NumberFormat format;
  if (precision != Precision::f32 && tile_unit() != nullptr) format.precision = Precision::bf16;
  return format;
}

void store_input_ranges(const InputRanges& ranges, StateDict& weights) {
  for (const auto& [layer, range] : ranges) {
    if (range.images == 0) continue;
    weights.metadata[kPrefix + layer] = fmt::format("{:.6g},{:.6g}", range.low, range.high);
  }
}

}  // namespace penumbra::nn
