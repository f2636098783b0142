#include "weights_tools/weight_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "nn/base/text.h"

namespace penumbra::weights_tools {

namespace {

constexpr std::array<std::string_view, 2> kPrefixes = {"module.", "model."};
// Names that PyTorch reserves for wrappers, also of parts of a network.
constexpr std::array<std::string_view, 3> kReserved = {"_orig_mod.", "_fsdp_wrapped_module.",
                                                       "_checkpoint_wrapped_module."};

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

}  // namespace

std::vector<std::string> without_wrappers(std::vector<std::string> names) {
  if (names.empty()) return names;
  for (std::string& name : names) {
    for (const std::string_view part : kReserved) erase_all(name, part);
  }
  while (strip_shared_prefix(names)) {
  }
  return names;
}

bool are_of_a_known_network(const std::vector<std::string>& names) {
  const std::vector<std::string> own = without_wrappers(names);
  return std::any_of(own.begin(), own.end(), [](const std::string& name) {
    return name.starts_with("backbone.body.layer1.") || name.starts_with("layer1.0.conv1.") ||
           name.starts_with("model.0.conv.");
  });
}

void unwrap_names(nn::StateDict& state) {
  std::vector<std::string> names;
  for (const auto& [name, tensor] : state.tensors) {
    if (name != kAveragingCounter) names.push_back(name);
  }
  const std::vector<std::string> own = without_wrappers(names);
  if (own == names || std::set(own.begin(), own.end()).size() < own.size()) return;
  std::map<std::string, nn::StoredTensor> tensors;
  for (std::size_t i = 0; i < names.size(); ++i) tensors[own[i]] = std::move(state.tensors.at(names[i]));
  std::string_view counter;
  if (state.tensors.contains(std::string(kAveragingCounter))) counter = ", n_averaged left out";
  state.notes.push_back(fmt::format("names without their wrappers' prefixes: '{}' for '{}'{}",
                                    printable(own.front()), printable(names.front()), counter));
  state.tensors = std::move(tensors);
}

}  // namespace penumbra::weights_tools
