#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/base/file_in_the_making.h"
#include "nn/base/text.h"
#include "nn/io/safetensors.h"

namespace penumbra::nn {

namespace {

using Named = std::pair<const std::string, StoredTensor>;

void check(const StateDict& state, const std::string& place) {
  for (const auto& [key, value] : state.metadata) {
    if (!is_utf8(key) || !is_utf8(value)) {
      throw InputError(place + ": metadata", "UTF-8", printable(key) + "=" + printable(value));
    }
  }
  for (const auto& [name, tensor] : state.tensors) {
    const std::string where = fmt::format("{}: \"{}\"", place, printable(name));
    if (name == "__metadata__") throw InputError(where, "another name", "the one that the format reserves");
    if (!is_utf8(name)) throw InputError(where, "a name in UTF-8", "other bytes");
    const auto size = bytes_of(tensor.type, static_cast<std::uint64_t>(tensor.elements()));
    if (size != tensor.bytes.size()) {
      throw InputError(where, fmt::format("{} bytes", size.value_or(0)),
                       fmt::format("{}", tensor.bytes.size()));
    }
  }
}

}  // namespace

void write_safetensors(const std::filesystem::path& path, const StateDict& state) {
  check(state, path.string());
  // Sizes are multiples of the element size, so with larger elements first every offset is aligned.
  std::vector<const Named*> order;
  for (const Named& named : state.tensors) order.push_back(&named);
  std::stable_sort(order.begin(), order.end(), [](const Named* a, const Named* b) {
    return size_of(a->second.type) > size_of(b->second.type);
  });

  nlohmann::ordered_json header = nlohmann::ordered_json::object();
  if (!state.metadata.empty()) header["__metadata__"] = state.metadata;
  std::size_t offset = 0;
  // nlohmann's ordered object finds a key in linear time: append entries, the names are known to differ.
  auto& entries = header.get_ref<nlohmann::ordered_json::object_t&>();
  for (const Named* named : order) {
    const auto& [name, tensor] = *named;
    const std::size_t end = offset + tensor.bytes.size();
    nlohmann::ordered_json entry = {
        {"dtype", to_string(tensor.type)}, {"shape", tensor.shape}, {"data_offsets", {offset, end}}};
    entries.push_back({name, std::move(entry)});
    offset = end;
  }
  std::string json = header.dump();
  json.resize((json.size() + 7) / 8 * 8, ' ');
  if (json.size() > kLongestSafetensorsHeader) {
    throw Error(fmt::format("{}: cannot be written: its header would have {} bytes, at most {} are readable",
                            path.string(), json.size(), kLongestSafetensorsHeader));
  }

  FileInTheMaking file(path);
  const std::uint64_t header_size = json.size();
  file.write(&header_size, sizeof(header_size));
  file.write(json.data(), json.size());
  for (const Named* named : order) file.write(named->second.bytes.data(), named->second.bytes.size());
  file.commit();
}

}  // namespace penumbra::nn
