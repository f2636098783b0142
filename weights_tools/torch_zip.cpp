#include "weights_tools/torch_zip.h"

#include <fmt/format.h>

#include <utility>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "weights_tools/pickle_machine.h"
#include "weights_tools/torch_state_dict.h"
#include "weights_tools/torch_storages.h"
#include "weights_tools/zip_archive.h"

namespace penumbra::weights_tools {

namespace {

constexpr std::string_view kPickleName = "data.pkl";
constexpr std::uint64_t kLongestByteOrder = 16;

// The folder that holds everything, with its slash: what stands before "data.pkl".
std::string find_folder(const ZipArchive& archive, const std::string& place) {
  std::string folder;
  int found = 0;
  for (const auto& [name, entry] : archive.entries()) {
    const std::size_t slash = name.find('/');
    const std::size_t begin = slash == std::string::npos ? 0 : slash + 1;
    if (std::string_view(name).substr(begin) == kPickleName) {
      folder = name.substr(0, begin);
      ++found;
    }
  }
  if (found != 1) {
    throw InputError(place, "a PyTorch zip file with one data.pkl",
                     found == 0 ? "a zip file without" : fmt::format("{}", found));
  }
  return folder;
}

void check_byte_order(const ZipArchive& archive, const std::string& folder, const std::string& place,
                      MemoryBudget& budget) {
  const auto found = archive.entries().find(folder + "byteorder");
  if (found == archive.entries().end()) return;
  std::string order = "something long";
  if (found->second.size <= kLongestByteOrder) {
    const ZipArchive::Bytes read = archive.read(found->first, found->second, budget);
    order.assign(reinterpret_cast<const char*>(read.bytes.data()), read.bytes.size());
  }
  if (order != "little") throw InputError(place + ": byteorder", "little", printable(order));
}

}  // namespace

nn::StateDict read_torch_zip(const std::shared_ptr<const MappedFile>& file, const std::string& place,
                             std::string_view key) {
  const ZipArchive archive(file->bytes(), place);
  MemoryBudget budget(file->bytes().size());
  const std::string folder = find_folder(archive, place);
  check_byte_order(archive, folder, place, budget);

  const std::string pickle_place = fmt::format("{}: {}", place, kPickleName);
  const auto pickle_entry = archive.entries().find(folder + std::string(kPickleName));
  if (pickle_entry->second.size > kLongestPickle) {
    throw InputError(pickle_place, fmt::format("at most {} bytes", kLongestPickle),
                     fmt::format("{}", pickle_entry->second.size));
  }
  const ZipArchive::Bytes pickle = archive.read(pickle_entry->first, pickle_entry->second, budget);
  const PickledObject object = run_pickle(pickle.bytes, 0, pickle_place);
  TorchState torch = find_state_dict(object, pickle_place, key);

  nn::StateDict state;
  state.source = place;
  state.file = file;
  std::vector<std::span<const std::byte>> storages(object.storages.size());
  std::vector<bool> is_read(object.storages.size(), false);
  for (const TorchTensor* tensor : tensors_to_read(torch)) {
    if (is_read[tensor->storage]) continue;
    is_read[tensor->storage] = true;
    const StorageRequest& request = object.storages[tensor->storage];
    const std::string where = fmt::format("{}: tensor \"{}\"", place, printable(tensor->name));
    const auto found = archive.entries().find(fmt::format("{}data/{}", folder, request.key));
    if (found == archive.entries().end()) {
      throw InputError(where, fmt::format("its storage data/{}", printable(request.key)),
                       "no such entry in the zip file");
    }
    const std::uint64_t size = found->second.size, element = nn::size_of(request.type);
    if (size % element != 0 || size / element != static_cast<std::uint64_t>(request.elements)) {
      throw InputError(where, fmt::format("a storage of {} elements of {} bytes", request.elements, element),
                       fmt::format("{} bytes", size));
    }
    const ZipArchive::Bytes read = archive.read(found->first, found->second, budget);
    storages[tensor->storage] = read.bytes;
    if (read.owner) {
      state.owners.push_back(read.owner);
    } else {
      file->forget(read.bytes);  // until it is read as a weight
    }
  }
  add_state(object, std::move(torch), storages, budget, state);
  return state;
}

}  // namespace penumbra::weights_tools
