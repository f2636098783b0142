#include "weights_tools/torch_legacy.h"

#include <fmt/format.h>

#include <map>
#include <string_view>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "weights_tools/byte_reader.h"
#include "weights_tools/pickle_machine.h"
#include "weights_tools/torch_state_dict.h"
#include "weights_tools/torch_storages.h"

namespace penumbra::weights_tools {

namespace {

constexpr std::string_view kMagicNumber = "\x6c\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19";
constexpr std::int64_t kProtocolVersion = 1001;
constexpr std::byte kPickleProtocolOpcode{0x80};

std::size_t read_preamble(std::span<const std::byte> bytes, const std::string& place) {
  const PickledObject magic = run_pickle(bytes, 0, place);
  const Value& number = magic[magic.root];
  if (number.kind != ValueKind::bytes || number.text != kMagicNumber) {
    throw InputError(place, "a checkpoint written by torch.save", "a pickle of another kind");
  }
  const PickledObject protocol = run_pickle(bytes, magic.end, place);
  const Value& version = protocol[protocol.root];
  if (version.kind != ValueKind::integer || version.number != kProtocolVersion) {
    throw InputError(fmt::format("{}: byte {}", place, magic.end),
                     fmt::format("protocol version {}", kProtocolVersion), "another");
  }
  const PickledObject system = run_pickle(bytes, protocol.end, place);
  const Value& facts = system[system.root];
  for (std::size_t i = 0; facts.kind == ValueKind::dict && i + 1 < facts.items.size(); i += 2) {
    const Value& name = system[facts.items[i]];
    const Value& value = system[facts.items[i + 1]];
    if (name.kind == ValueKind::text && name.text == "little_endian" &&
        !(value.kind == ValueKind::boolean && value.number == 1)) {
      throw InputError(fmt::format("{}: byte {}", place, protocol.end), "little_endian: True",
                       "another value");
    }
  }
  return system.end;
}

// The bytes of each of object.storages, which follow the pickled list of their keys.
std::vector<std::span<const std::byte>> read_storages(std::span<const std::byte> bytes,
                                                      const PickledObject& object, const std::string& place) {
  const PickledObject keys = run_pickle(bytes, object.end, place);
  const Value& list = keys[keys.root];
  const std::string list_place = fmt::format("{}: byte {}", place, object.end);
  if (list.kind != ValueKind::list)
    throw InputError(list_place, "a list of storage keys", to_string(list.kind));

  std::map<std::string_view, std::size_t> index;
  for (std::size_t i = 0; i < object.storages.size(); ++i) index[object.storages[i].key] = i;
  std::vector<std::span<const std::byte>> storages(object.storages.size());
  std::vector<bool> is_read(object.storages.size(), false);
  std::string where;
  ByteReader reader(bytes, keys.end, [&](std::uint64_t needed) {
    throw InputError(where, fmt::format("{} more bytes", needed), "the end of the file (truncated?)");
  });
  for (const ValueId id : list.items) {
    const Value& key = keys[id];
    const auto found = key.kind == ValueKind::text ? index.find(key.text) : index.end();
    if (found == index.end() || is_read[found->second]) {
      throw InputError(list_place, "the keys of the tensors' storages, each once",
                       key.kind == ValueKind::text ? "'" + printable(key.text) + "'" : to_string(key.kind));
    }
    const StorageRequest& request = object.storages[found->second];
    where = fmt::format("{}: byte {}: storage '{}'", place, reader.position(), printable(request.key));
    const auto elements = reader.number<std::int64_t>();
    if (elements != request.elements) {
      throw InputError(where, fmt::format("{} elements", request.elements), fmt::format("{}", elements));
    }
    const std::uint64_t element = nn::size_of(request.type);
    std::uint64_t size = 0;  // elements >= 0: find_storage has checked it
    if (__builtin_mul_overflow(static_cast<std::uint64_t>(elements), element, &size)) {
      throw InputError(where, "a storage of less than 2^63 bytes", fmt::format("{} elements", elements));
    }
    storages[found->second] = reader.take(size);
    is_read[found->second] = true;
  }
  for (std::size_t i = 0; i < storages.size(); ++i) {
    if (!is_read[i]) {
      throw InputError(list_place, "the keys of all of the tensors' storages",
                       fmt::format("no '{}'", printable(object.storages[i].key)));
    }
  }
  return storages;
}

}  // namespace

bool begins_like_a_pickle(std::span<const std::byte> bytes) {
  return bytes.size() >= 2 && bytes[0] == kPickleProtocolOpcode && bytes[1] <= std::byte{5};
}

nn::StateDict read_torch_legacy(const std::shared_ptr<const MappedFile>& file, const std::string& place,
                                std::string_view key) {
  const std::span<const std::byte> bytes = file->bytes();
  const std::size_t begin = read_preamble(bytes, place);
  const PickledObject object = run_pickle(bytes, begin, place);
  const std::vector<std::span<const std::byte>> storages = read_storages(bytes, object, place);

  nn::StateDict state;
  state.source = place;
  state.file = file;
  MemoryBudget budget(bytes.size());
  add_state(object, find_state_dict(object, place, key), storages, budget, state);
  return state;
}

}  // namespace penumbra::weights_tools
