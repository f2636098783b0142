#include "weights_tools/torch_state_dict.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "weights_tools/find_weights.h"

namespace penumbra::weights_tools {

namespace {

constexpr std::size_t kMostTensors = 1U << 18;
constexpr std::size_t kMostDimensions = 64;

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

// PyTorch delays some changes of sign to when the elements are used.
void check_metadata(const PickledObject& object, const Value& value, const std::string& where) {
  constexpr std::size_t kMetadata = 4;
  if (value.items.size() <= kMetadata) return;
  for (const std::string_view mark : {"neg", "conj"}) {
    const Value* found = object.find(object[value.items[kMetadata]], mark);
    if (found != nullptr && found->kind == ValueKind::boolean && found->number != 0) {
      throw InputError(
          where, "elements as they are stored",
          fmt::format("elements that are still to be {} (its metadata: {}; save tensor.resolve_{}())",
                      mark == "neg" ? "negated" : "conjugated", mark, mark));
    }
  }
}

TorchTensor read_tensor(const PickledObject& object, const Value& value, std::string name,
                        const std::string& place) {
  if (value.kind == ValueKind::unread_tensor) {
    throw InputError(
        fmt::format("{}: tensor \"{}\"", place, printable(name)), "a dense tensor of plain numbers",
        fmt::format("one of {} (sparse, quantised and other tensors are not read)", printable(value.text)));
  }
  const std::string where = fmt::format("{}: byte {}: tensor \"{}\"", place, value.number, printable(name));
  check_metadata(object, value, where);
  if (!is_utf8(name)) throw InputError(where, "a name in UTF-8", "other bytes");
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

// Tensors of u16, u32, u64, complex32 and float8, which PyTorch pickles by a function of their own: no
// network here uses them. What was left out, if anything.
std::optional<std::string> leave_out_odd_types(const PickledObject& object,
                                               std::vector<NamedValue>& tensors) {
  constexpr std::size_t kMostListed = 10;
  std::vector<std::string> names;
  std::erase_if(tensors, [&](const NamedValue& tensor) {
    const Value& value = object[tensor.value];
    if (value.kind != ValueKind::unread_tensor || value.text != "_rebuild_tensor_v3") return false;
    names.push_back(printable(tensor.name, 80));
    return true;
  });
  if (names.empty()) return std::nullopt;
  const std::size_t count = names.size();
  names.resize(std::min(count, kMostListed));
  return fmt::format("tensors of u16, u32, u64, complex32 or float8 left out: {}{}", fmt::join(names, ", "),
                     count > kMostListed ? fmt::format(" and {} more", count - kMostListed) : "");
}

}  // namespace

TorchState find_state_dict(const PickledObject& object, const std::string& place, std::string_view key) {
  FoundWeights found = find_weights(object, place, key);
  if (found.tensors.size() > kMostTensors) {
    throw InputError(place, fmt::format("at most {} tensors", kMostTensors), "more");
  }
  TorchState state;
  state.metadata = std::move(found.metadata);
  state.notes = std::move(found.notes);
  if (std::optional<std::string> note = leave_out_odd_types(object, found.tensors)) {
    state.notes.push_back(std::move(*note));
  }
  for (NamedValue& tensor : found.tensors) {
    state.tensors.push_back(read_tensor(object, object[tensor.value], std::move(tensor.name), place));
  }
  if (found.stride) state.stride = read_tensor(object, object[*found.stride], "stride", place);
  return state;
}

}  // namespace penumbra::weights_tools
