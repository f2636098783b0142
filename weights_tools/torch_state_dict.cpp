#include "weights_tools/torch_state_dict.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <string_view>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::weights_tools {

namespace {

constexpr std::array<std::string_view, 3> kWrappers = {"state_dict", "model_state_dict", "model"};
constexpr int kDeepestWrapper = 4;
constexpr std::size_t kMostTensors = 1U << 18;
constexpr std::size_t kMostDimensions = 64;
constexpr std::size_t kLongestName = 1024;  // bytes
constexpr std::string_view kParallelPrefix = "module.";

bool holds_tensors(const PickledObject& object, const Value& dict) {
  for (std::size_t i = 1; i < dict.items.size(); i += 2) {
    if (object[dict.items[i]].kind == ValueKind::tensor) return true;
  }
  return false;
}

// What stands under `key`, or null.
const Value* find_entry(const PickledObject& object, const Value& dict, std::string_view key) {
  const Value* found = nullptr;
  for (std::size_t i = 0; i + 1 < dict.items.size(); i += 2) {
    const Value& name = object[dict.items[i]];
    if (name.kind == ValueKind::text && name.text == key) found = &object[dict.items[i + 1]];
  }
  return found;
}

// The dict with the tensors. A wrapper is preferred to tensors beside it: those are losses and the like.
const Value* find_tensors(const PickledObject& object, const Value& dict, int depth) {
  if (depth < kDeepestWrapper) {
    for (const std::string_view wrapper : kWrappers) {
      const Value* inner = find_entry(object, dict, wrapper);
      if (inner == nullptr || inner->kind != ValueKind::dict) continue;
      const Value* found = find_tensors(object, *inner, depth + 1);
      if (found != nullptr) return found;
    }
  }
  return holds_tensors(object, dict) ? &dict : nullptr;
}

std::string list_keys(const PickledObject& object, const Value& dict) {
  std::string list;
  for (std::size_t i = 0; i < std::min<std::size_t>(dict.items.size(), 16); i += 2) {
    const Value& key = object[dict.items[i]];
    if (!list.empty()) list += ", ";
    list +=
        key.kind == ValueKind::text ? fmt::format("\"{}\"", printable(key.text, 40)) : to_string(key.kind);
  }
  if (dict.items.size() > 16) list += ", ...";
  return list.empty() ? "an empty dict" : fmt::format("a dict with {}", list);
}

// Whole numbers >= 0: a size or a stride.
std::vector<std::int64_t> read_extents(const PickledObject& object, const Value& tuple,
                                       const std::string& where, std::string_view what) {
  std::vector<std::int64_t> extents;
  for (const ValueId id : tuple.items) {
    const Value& extent = object[id];
    if (extent.kind != ValueKind::integer || extent.number < 0) {
      const bool is_integer = extent.kind == ValueKind::integer;
      throw InputError(where, fmt::format("a {} of whole numbers >= 0", what),
                       is_integer ? std::to_string(extent.number) : to_string(extent.kind));
    }
    extents.push_back(extent.number);
  }
  return extents;
}

// Throws where an index of the tensor lies outside the `elements` elements from its slice's begin.
void check_indices(const TorchTensor& tensor, std::int64_t elements, const std::string& where) {
  std::int64_t count = 1;
  bool fits = tensor.offset >= 0;
  for (const std::int64_t extent : tensor.shape) {
    if (extent == 0) return;  // no element, so no index
    fits = fits && !__builtin_mul_overflow(count, extent, &count);
  }
  std::int64_t last = tensor.offset;
  for (std::size_t d = 0; d < tensor.shape.size(); ++d) {
    std::int64_t reach = 0;
    fits = fits && !__builtin_mul_overflow(tensor.shape[d] - 1, tensor.stride[d], &reach) &&
           !__builtin_add_overflow(last, reach, &last);
  }
  if (!fits || last >= elements) {
    throw InputError(where, fmt::format("elements within its storage of {}", elements),
                     fmt::format("offset {}, size [{}], stride [{}]", tensor.offset,
                                 fmt::join(tensor.shape, ", "), fmt::join(tensor.stride, ", ")));
  }
}

TorchTensor read_tensor(const PickledObject& object, const Value& value, std::string name,
                        const std::string& place) {
  const std::string where = fmt::format("{}: byte {}: tensor \"{}\"", place, value.number, printable(name));
  if (!is_utf8(name) || name.size() > kLongestName) {
    throw InputError(where, fmt::format("a name in UTF-8 of at most {} bytes", kLongestName), "another");
  }
  const Value& size = object[value.items[2]];
  const Value& stride = object[value.items[3]];
  if (size.items.size() != stride.items.size() || size.items.size() > kMostDimensions) {
    throw InputError(where, fmt::format("size and stride of the same length, at most {}", kMostDimensions),
                     fmt::format("{} and {}", size.items.size(), stride.items.size()));
  }
  const StorageSlice& slice = object.slices[static_cast<std::size_t>(object[value.items[0]].number)];
  TorchTensor tensor{.name = std::move(name),
                     .storage = slice.storage,
                     .offset = object[value.items[1]].number,
                     .shape = read_extents(object, size, where, "size"),
                     .stride = read_extents(object, stride, where, "stride")};
  check_indices(tensor, slice.elements, where);
  const bool is_empty = std::find(tensor.shape.begin(), tensor.shape.end(), 0) != tensor.shape.end();
  tensor.offset = is_empty ? 0 : tensor.offset + slice.offset;
  return tensor;
}

void strip_parallel_prefix(std::vector<TorchTensor>& tensors) {
  const bool shared = std::all_of(tensors.begin(), tensors.end(), [](const TorchTensor& tensor) {
    return tensor.name.starts_with(kParallelPrefix);
  });
  if (!shared) return;
  for (TorchTensor& tensor : tensors) tensor.name.erase(0, kParallelPrefix.size());
}

}  // namespace

std::vector<TorchTensor> find_state_dict(const PickledObject& object, const std::string& place) {
  const std::string_view wanted =
      "a dict of tensors, alone or under \"state_dict\", \"model_state_dict\" or \"model\"";
  const Value& root = object[object.root];
  if (root.kind != ValueKind::dict) throw InputError(place, wanted, to_string(root.kind));
  const Value* dict = find_tensors(object, root, 0);
  if (dict == nullptr) throw InputError(place, wanted, list_keys(object, root));

  std::map<std::string_view, ValueId> entries;
  for (std::size_t i = 0; i + 1 < dict->items.size(); i += 2) {
    const Value& name = object[dict->items[i]];
    if (name.kind == ValueKind::text) entries[name.text] = dict->items[i + 1];
  }
  std::vector<TorchTensor> tensors;
  for (const auto& [name, id] : entries) {
    const Value& value = object[id];
    if (value.kind != ValueKind::tensor) continue;
    if (tensors.size() == kMostTensors) {
      throw InputError(place, fmt::format("at most {} tensors", kMostTensors), "more");
    }
    tensors.push_back(read_tensor(object, value, std::string(name), place));
  }
  strip_parallel_prefix(tensors);
  return tensors;
}

}  // namespace penumbra::weights_tools
