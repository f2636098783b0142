// Numbers that a weights file's metadata states about its network. Metadata are texts by key: safetensors'
// __metadata__, or what `penumbra convert --metadata` wrote.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nn/io/state_dict.h"

namespace penumbra::nn {

// The keys that networks read; docs/formats.md says what each means. There are input_range.LAYER, too.
inline constexpr std::string_view kMetadataKeys[] = {
    "batch_norm_eps", "classes",  "network", "box_head_layers", "mask_head_layers", "anchor_sizes",
    "min_size",       "max_size", "stride",  "source_format",   "rpn_candidates",   "rpn_proposals"};

struct NumberRange {
  double least = 0.0, most = 0.0;  // both ends included
};

// The number under `key`, or none where the key is missing. Throws InputError that names file and key for
// anything that is not a number in `range`.
std::optional<double> metadata_number(const StateDict& weights, const std::string& key,
                                      const NumberRange& range);
// The same for a whole number.
std::optional<int> metadata_integer(const StateDict& weights, const std::string& key,
                                    const NumberRange& range);
// `count` numbers separated by commas, or an empty list where the key is missing.
std::vector<double> metadata_numbers(const StateDict& weights, const std::string& key, std::size_t count,
                                     const NumberRange& range);

}  // namespace penumbra::nn
