#include "weights_tools/pickle_calls.h"

#include <fmt/format.h>

#include <algorithm>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::weights_tools {

namespace {

// Keys are counters or addresses; comparing ones of megabytes, again and again, would take hours.
constexpr std::size_t kLongestStorageKey = 256;

const std::vector<ValueId>& arguments_of(PickleHeap& heap, ValueId arguments, std::size_t fewest) {
  const Value& tuple = heap.expect(arguments, ValueKind::tuple, "the call's arguments");
  if (tuple.items.size() < fewest) {
    heap.fail(fmt::format("a call with at least {} arguments", fewest),
              fmt::format("{}", tuple.items.size()));
  }
  return tuple.items;
}

// OrderedDict() or, from Python 2, OrderedDict([[key, value], ...]).
ValueId make_ordered_dict(PickleHeap& heap, ValueId arguments) {
  const std::vector<ValueId>& given = arguments_of(heap, arguments, 0);
  if (given.empty()) return heap.add({.kind = ValueKind::dict});
  if (given.size() > 1) heap.fail("OrderedDict with at most one argument", fmt::format("{}", given.size()));
  const ValueId pairs = given[0];
  const ValueKind kind = heap[pairs].kind;
  if (kind != ValueKind::list && kind != ValueKind::tuple) heap.fail("a list of pairs", to_string(kind));
  const ValueId dict = heap.add({.kind = ValueKind::dict});
  for (std::size_t i = 0; i < heap[pairs].items.size(); ++i) {
    const Value& pair = heap[heap[pairs].items[i]];
    const bool is_pair =
        (pair.kind == ValueKind::list || pair.kind == ValueKind::tuple) && pair.items.size() == 2;
    if (!is_pair) heap.fail("a list of pairs", fmt::format("{} in it", to_string(pair.kind)));
    const ValueId key = pair.items[0], value = pair.items[1];
    heap.append(dict, key);
    heap.append(dict, value);
  }
  return dict;
}

// dict(), dict({...}), defaultdict(factory, {...}): the pairs of every argument that has some.
ValueId make_dict(PickleHeap& heap, ValueId arguments) {
  const std::vector<ValueId> given = arguments_of(heap, arguments, 0);
  const ValueId dict = heap.add({.kind = ValueKind::dict});
  for (const ValueId mapping : given) {
    if (heap[mapping].kind != ValueKind::dict) continue;
    for (std::size_t i = 0; i < heap[mapping].items.size(); ++i) heap.append(dict, heap[mapping].items[i]);
  }
  return dict;
}

// set() or set([...]).
ValueId make_set(PickleHeap& heap, ValueId arguments) {
  const std::vector<ValueId> given = arguments_of(heap, arguments, 0);
  const ValueId set = heap.add({.kind = ValueKind::set});
  for (const ValueId list : given) {
    if (heap[list].kind != ValueKind::list && heap[list].kind != ValueKind::tuple) continue;
    for (std::size_t i = 0; i < heap[list].items.size(); ++i) heap.append(set, heap[list].items[i]);
  }
  return set;
}

ValueId rebuild_tensor(PickleHeap& heap, ValueId arguments) {
  constexpr std::size_t kMetadata = 6;  // after storage, offset, size, stride, requires_grad and hooks
  const std::vector<ValueId>& given = arguments_of(heap, arguments, 4);
  Value tensor{.kind = ValueKind::tensor,
               .number = static_cast<std::int64_t>(heap.position()),
               .items = {given[0], given[1], given[2], given[3]}};
  if (given.size() > kMetadata) tensor.items.push_back(given[kMetadata]);
  heap.expect(given[0], ValueKind::storage, "the tensor's storage");
  heap.expect(given[1], ValueKind::integer, "the tensor's offset");
  heap.expect(given[2], ValueKind::tuple, "the tensor's size");
  heap.expect(given[3], ValueKind::tuple, "the tensor's stride");
  return heap.add(std::move(tensor));
}

ValueId rebuild_parameter(PickleHeap& heap, ValueId arguments) {
  const ValueId tensor = arguments_of(heap, arguments, 1)[0];
  if (heap[tensor].kind != ValueKind::unread_tensor) {
    heap.expect(tensor, ValueKind::tensor, "the parameter's data");
  }
  return tensor;
}

ValueId rebuild_from_type(PickleHeap& heap, ValueId arguments) {
  const std::vector<ValueId>& given = arguments_of(heap, arguments, 3);
  const Value& function = heap.expect(given[0], ValueKind::global, "the function that rebuilds the tensor");
  const GlobalKind kind = function.global.kind;
  if (kind != GlobalKind::rebuild_tensor && kind != GlobalKind::rebuild_parameter &&
      kind != GlobalKind::unread_tensor) {
    heap.fail("a function that rebuilds a tensor", "another");
  }
  return call(heap, given[0], given[2]);
}

// getattr(class, name) names a part of a class: a scheduler's state does so. What leads out of the class, as
// __globals__ does, is refused.
ValueId make_attribute(PickleHeap& heap, ValueId arguments) {
  const std::vector<ValueId>& given = arguments_of(heap, arguments, 2);
  const std::string_view name = heap.expect(given[1], ValueKind::text, "the attribute's name").text;
  if (name.starts_with("__")) {
    heap.fail(
        "attributes of a class by their names",
        fmt::format("getattr of '{}' (nothing was executed; the file may be an attack)", printable(name)));
  }
  // How Python restores a time zone, zoneinfo.ZoneInfo._unpickle(key, ...): as a call of the class.
  if (name == "_unpickle" && heap[given[0]].kind == ValueKind::global && heap[given[0]].text == "ZoneInfo") {
    return given[0];
  }
  return heap.add({.kind = ValueKind::attribute});
}

// An object of a class that is a record. Old pickles name the class in an argument. Arguments that may hold
// weights, as torch.compile's wrapper has its network, become attributes "0", "1", ...
ValueId make_object(PickleHeap& heap, ValueId function, ValueId arguments) {
  std::string_view name = heap[function].text;
  if (name == "_reconstructor" || name == "__newobj__") {
    const std::vector<ValueId>& given = arguments_of(heap, arguments, 1);
    if (heap[given[0]].kind == ValueKind::global) name = heap[given[0]].text;
  }
  const ValueId made = heap.add({.kind = ValueKind::object, .text = name});
  if (heap[arguments].kind != ValueKind::tuple) return made;
  constexpr std::string_view kNumbers = "0123456789";
  for (std::size_t i = 0; i < std::min(heap[arguments].items.size(), kNumbers.size()); ++i) {
    const ValueId argument = heap[arguments].items[i];
    const ValueKind kind = heap[argument].kind;
    if (kind != ValueKind::object && kind != ValueKind::dict) continue;
    heap.append(made, heap.add({.kind = ValueKind::text, .text = kNumbers.substr(i, 1)}));
    heap.append(made, argument);
  }
  return made;
}

}  // namespace

ValueId call(PickleHeap& heap, ValueId function, ValueId arguments) {
  const ValueKind kind = heap[function].kind;
  // An attrgetter or methodcaller does no harm until it is called.
  const std::string_view name = heap[function].text;
  const bool is_getter = kind == ValueKind::object && (name == "attrgetter" || name == "methodcaller");
  if (kind == ValueKind::attribute || is_getter) {
    heap.fail("calls of classes and functions",
              "a call of what getattr, attrgetter or methodcaller names (nothing was executed; the file may "
              "be an attack)");
  }
  if (kind == ValueKind::object) return make_object(heap, function, arguments);  // functools.partial
  const Global global = heap.expect(function, ValueKind::global, "what is called").global;
  switch (global.kind) {
    case GlobalKind::ordered_dict:
      return make_ordered_dict(heap, arguments);
    case GlobalKind::dict:
      return make_dict(heap, arguments);
    case GlobalKind::set:
      return make_set(heap, arguments);
    case GlobalKind::size: {
      const ValueId extents = arguments_of(heap, arguments, 1)[0];
      const ValueKind extents_kind = heap[extents].kind;
      if (extents_kind != ValueKind::tuple) heap.fail("torch.Size of a tuple", to_string(extents_kind));
      return extents;
    }
    case GlobalKind::rebuild_tensor:
      return rebuild_tensor(heap, arguments);
    case GlobalKind::rebuild_parameter:
      return rebuild_parameter(heap, arguments);
    case GlobalKind::rebuild_from_type:
      return rebuild_from_type(heap, arguments);
    case GlobalKind::unread_tensor:
      return heap.add({.kind = ValueKind::unread_tensor, .text = heap[function].text});
    case GlobalKind::attribute:
      return make_attribute(heap, arguments);
    case GlobalKind::record:
      return make_object(heap, function, arguments);
    case GlobalKind::storage:
      break;
  }
  heap.fail("a storage only inside a persistent id", "a call that makes one");
}

ValueId find_storage(PickleHeap& heap, ValueId persistent_id) {
  const std::vector<ValueId>& id = heap.expect(persistent_id, ValueKind::tuple, "the persistent id").items;
  if (id.size() < 2) heap.fail("a persistent id of at least 2 parts", fmt::format("{}", id.size()));
  const std::string_view tag = heap.expect(id[0], ValueKind::text, "the persistent id's kind").text;
  if (tag == "module") return id[1];  // a class with its source text, in whole networks of the legacy format
  if (tag != "storage")
    heap.fail("the persistent id of a storage or a module", fmt::format("'{}'", printable(tag)));
  if (id.size() < 5 || id.size() > 6) {
    heap.fail("a storage's persistent id of 5 or 6 parts", fmt::format("{}", id.size()));
  }
  const Global global = heap.expect(id[1], ValueKind::global, "the storage's type").global;
  if (global.kind != GlobalKind::storage) heap.fail("the storage's type", "another class");
  const std::string_view key = heap.expect(id[2], ValueKind::text, "the storage's key").text;
  if (key.size() > kLongestStorageKey) {
    heap.fail(fmt::format("a storage key of at most {} bytes", kLongestStorageKey),
              fmt::format("{}", key.size()));
  }
  const std::int64_t elements = heap.expect(id[4], ValueKind::integer, "the storage's element count").number;
  if (elements < 0) heap.fail("an element count >= 0", fmt::format("{}", elements));

  PickledObject& object = heap.object();
  const auto [found, is_new] = heap.storage_by_key().try_emplace(key, object.storages.size());
  if (is_new) {
    object.storages.push_back({key, global.type, elements, heap.position()});
  } else {
    const StorageRequest& known = object.storages[found->second];
    if (known.type != global.type || known.elements != elements) {
      heap.fail(fmt::format("storage '{}' as {} elements of {}", printable(key), known.elements,
                            nn::to_string(known.type)),
                fmt::format("{} of {}", elements, nn::to_string(global.type)));
    }
  }

  StorageSlice slice{found->second, 0, elements};
  if (id.size() == 6 && heap[id[5]].kind != ValueKind::none) {
    const std::vector<ValueId>& view = heap.expect(id[5], ValueKind::tuple, "the storage's view").items;
    if (view.size() != 3) heap.fail("a storage view of 3 parts", fmt::format("{}", view.size()));
    slice.offset = heap.expect(view[1], ValueKind::integer, "the view's offset").number;
    slice.elements = heap.expect(view[2], ValueKind::integer, "the view's element count").number;
    if (slice.offset < 0 || slice.elements < 0 || slice.offset > elements ||
        slice.elements > elements - slice.offset) {
      heap.fail(fmt::format("a view within the storage's {} elements", elements),
                fmt::format("{} elements from {}", slice.elements, slice.offset));
    }
  }
  object.slices.push_back(slice);
  return heap.add(
      {.kind = ValueKind::storage, .number = static_cast<std::int64_t>(object.slices.size() - 1)});
}

}  // namespace penumbra::weights_tools
