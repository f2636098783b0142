#include "nn/io/safetensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "nn/base/error.h"
#include "nn/base/mapped_file.h"
#include "nn/base/text.h"
#include "nn/io/safetensors_header.h"

namespace penumbra::nn {

namespace {

static_assert(std::endian::native == std::endian::little, "files are little-endian and viewed in place");

// The tensors must tile the data: ordered by offset, each begins where the one before ends, the last ends
// with the file. That excludes overlaps, offsets outside the file, and bytes that belong to no tensor.
void check_layout(std::vector<SafetensorsEntry>& tensors, std::uint64_t data_size, const std::string& place) {
  std::sort(tensors.begin(), tensors.end(), [](const SafetensorsEntry& a, const SafetensorsEntry& b) {
    return a.begin != b.begin ? a.begin < b.begin : a.end < b.end;
  });
  std::uint64_t position = 0;
  for (const SafetensorsEntry& tensor : tensors) {
    const std::string where = fmt::format("{}: \"{}\"", place, printable(tensor.name));
    if (tensor.end > data_size) {
      throw InputError(where, fmt::format("data_offsets within the file's {} data bytes", data_size),
                       fmt::format("[{}, {}]", tensor.begin, tensor.end));
    }
    if (tensor.begin != position) {
      throw InputError(where,
                       fmt::format("data to begin at offset {}, where the tensor before it ends", position),
                       fmt::format("offset {}", tensor.begin));
    }
    position = tensor.end;
  }
  if (position != data_size) {
    throw InputError(place, fmt::format("{} bytes of tensor data", position), fmt::format("{}", data_size));
  }
}

}  // namespace

StateDict read_safetensors(const std::filesystem::path& path) {
  const std::shared_ptr<const MappedFile> file = MappedFile::open(path);
  const std::span<const std::byte> bytes = file->bytes();
  const std::string place = path.string();
  if (bytes.size() < 8) {
    throw InputError(place, "a safetensors file of at least 8 bytes", fmt::format("{}", bytes.size()));
  }
  std::uint64_t header_size = 0;
  std::memcpy(&header_size, bytes.data(), 8);
  if (header_size > kLongestSafetensorsHeader) {
    throw InputError(place + ": byte 0",
                     fmt::format("a header of at most {} bytes", kLongestSafetensorsHeader),
                     fmt::format("a length of {}", header_size));
  }
  if (header_size > bytes.size() - 8) {
    throw InputError(place, fmt::format("a header of {} bytes", header_size),
                     fmt::format("a file that ends after {}", bytes.size() - 8));
  }
  const std::string_view json(reinterpret_cast<const char*>(bytes.data()) + 8, header_size);
  if (json.empty() || json.front() != '{') {
    throw InputError(place + ": byte 8", "a header that begins with {", "something else");
  }

  SafetensorsHeader header = parse_safetensors_header(json, place);
  const std::span<const std::byte> data = bytes.subspan(8 + header_size);
  check_layout(header.tensors, data.size(), place);

  StateDict state;
  state.source = place;
  state.metadata = std::move(header.metadata);
  for (SafetensorsEntry& entry : header.tensors) {
    state.tensors.emplace(
        std::move(entry.name),
        StoredTensor{entry.type, std::move(entry.shape), data.subspan(entry.begin, entry.end - entry.begin)});
  }
  state.file = file;
  return state;
}

}  // namespace penumbra::nn
