#include "weights_tools/weight_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <set>

#include "nn/base/text.h"

namespace penumbra::weights_tools {

namespace {

constexpr std::array<std::string_view, 2> kPrefixes = {"module.", "model."};
// Names that PyTorch reserves for wrappers, also of parts of a network.
constexpr std::array<std::string_view, 3> kReserved = {"_orig_mod.", "_fsdp_wrapped_module.",
                                                       "_checkpoint_wrapped_module."};

// How a tensor of each network that Penumbra runs begins, and one that stands at its end. A Mask R-CNN holds
// the first part of a ResNet, so it goes first.
struct KnownNetwork {
  std::string_view begin, last;
};
constexpr std::array kKnownNetworks = {
    KnownNetwork{"backbone.body.layer1.", "roi_heads.box_predictor.cls_score.weight"},
    KnownNetwork{"model.0.conv.", "model.24.m.0.weight"},
    KnownNetwork{"layer1.0.conv1.", "fc.weight"},
};

void erase_all(std::string& name, std::string_view part) {
  std::size_t found = 0;
  while ((found = name.find(part, found)) != std::string::npos) {
    if (found == 0 || name[found - 1] == '.') {
      name.erase(found, part.size());
    } else {
      found += part.size();
    }
  }
}

// YOLOv5 numbers its layers: model.0, model.1, ...
bool is_numbered(std::string_view name, std::string_view prefix) {
  return name.size() > prefix.size() && std::isdigit(static_cast<unsigned char>(name[prefix.size()])) != 0;
}

bool strip_shared_prefix(std::vector<std::string>& names) {
  for (const std::string_view prefix : kPrefixes) {
    const bool is_shared = std::all_of(names.begin(), names.end(), [&](const std::string& name) {
      return name.size() > prefix.size() && name.starts_with(prefix);
    });
    if (!is_shared) continue;
    // Numbers after "model." may be YOLOv5's layers or those of a Sequential inside a wrapper; only YOLOv5's
    // are blocks with parts of their own (model.0.conv.weight).
    const bool is_yolov5 =
        prefix == "model." && std::any_of(names.begin(), names.end(), [&](const auto& name) {
          return is_numbered(name, prefix) && name.find(".conv.") != std::string::npos;
        });
    if (is_yolov5) continue;
    for (std::string& name : names) name.erase(0, prefix.size());
    return true;
  }
  return false;
}

// The one prefix of a whole network that Penumbra runs, which may be empty; nothing where there are none or
// several.
std::optional<std::string> prefix_of_known_network(const std::vector<std::string>& names) {
  for (const KnownNetwork& network : kKnownNetworks) {
    std::set<std::string> prefixes;
    for (const std::string& name : names) {
      const std::size_t found = name.find(network.begin);
      if (found != std::string::npos && (found == 0 || name[found - 1] == '.')) {
        prefixes.insert(name.substr(0, found));
      }
    }
    if (prefixes.empty()) continue;
    const std::string last = *prefixes.begin() + std::string(network.last);
    const bool is_whole = std::find(names.begin(), names.end(), last) != names.end();
    if (prefixes.size() > 1 || !is_whole) return std::nullopt;
    return *prefixes.begin();
  }
  return std::nullopt;
}

// Takes the prefix of a known network off its names and empties the others, where they are few.
void strip_known_prefix(std::vector<std::string>& names) {
  constexpr std::size_t kNamesPerForeignOne = 4;
  const std::optional<std::string> prefix = prefix_of_known_network(names);
  if (!prefix || prefix->empty()) return;
  const auto has_prefix = [&](const std::string& name) { return name.starts_with(*prefix); };
  const auto own = static_cast<std::size_t>(std::count_if(names.begin(), names.end(), has_prefix));
  if ((names.size() - own) * kNamesPerForeignOne > own) return;
  for (std::string& name : names) name = has_prefix(name) ? name.substr(prefix->size()) : "";
}

}  // namespace

bool is_averaging_counter(std::string_view name) { return name == "n_averaged" || name == "steps"; }

OwnNames without_wrappers(const std::vector<std::string>& given) {
  std::vector<std::string> names;
  for (const std::string& name : given) {
    if (!is_averaging_counter(name)) names.push_back(name);
  }
  if (names.empty()) return {given, {}};
  const std::vector<std::string> wrapped = names;
  for (std::string& name : names) {
    for (const std::string_view part : kReserved) erase_all(name, part);
  }
  while (strip_shared_prefix(names)) {
  }
  strip_known_prefix(names);
  if (names == wrapped) return {given, {}};
  OwnNames own;
  for (std::size_t i = 0, next = 0; i < given.size(); ++i) {
    own.names.push_back(is_averaging_counter(given[i]) ? "" : names[next++]);
    if (own.names.back().empty()) own.left_out.push_back(given[i]);
  }
  return own;
}

bool are_of_a_known_network(const std::vector<std::string>& names) {
  const OwnNames own = without_wrappers(names);
  return std::any_of(own.names.begin(), own.names.end(), [](const std::string& name) {
    return std::any_of(kKnownNetworks.begin(), kKnownNetworks.end(),
                       [&](const KnownNetwork& network) { return name.starts_with(network.begin); });
  });
}

void unwrap_names(nn::StateDict& state) {
  constexpr std::size_t kMostListed = 10;
  std::vector<std::string> names;
  for (const auto& [name, tensor] : state.tensors) names.push_back(name);
  const OwnNames own = without_wrappers(names);
  if (own.names == names) return;
  std::map<std::string, nn::StoredTensor> tensors;
  std::string example;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (own.names[i].empty()) continue;
    if (!tensors.emplace(own.names[i], state.tensors.at(names[i])).second) return;  // two of one name
    if (example.empty()) {
      example = fmt::format("'{}' for '{}'", printable(own.names[i]), printable(names[i]));
    }
  }
  std::string note = "names without their wrappers' prefixes: " + example;
  for (std::size_t i = 0; i < std::min(own.left_out.size(), kMostListed); ++i) {
    note += fmt::format("{} {}", i == 0 ? "; left out:" : ",", printable(own.left_out[i]));
  }
  if (own.left_out.size() > kMostListed)
    note += fmt::format(" and {} more", own.left_out.size() - kMostListed);
  state.notes.push_back(std::move(note));
  state.tensors = std::move(tensors);
}

}  // namespace penumbra::weights_tools
