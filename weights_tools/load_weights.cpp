#include "weights_tools/load_weights.h"

#include <cstring>
#include <map>
#include <string>
#include <string_view>

#include "nn/base/error.h"
#include "nn/base/mapped_file.h"
#include "nn/base/text.h"
#include "nn/io/safetensors.h"
#include "weights_tools/torch_legacy.h"
#include "weights_tools/torch_zip.h"
#include "weights_tools/weight_names.h"

namespace penumbra::weights_tools {

namespace {

// The order matters: a safetensors file begins with its header's length, whose lowest bytes may look like a
// pickle's first ones (0x80 0x02 is a header of 640 bytes), but no pickle or zip file has a small number in
// its first 8 bytes and a brace after them.
CheckpointFormat recognise(std::span<const std::byte> bytes, const std::string& place) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const bool has_brace = text.size() > 8 && text[8] == '{';
  if (has_brace) {
    std::uint64_t header_size = 0;
    std::memcpy(&header_size, bytes.data(), 8);
    if (header_size <= nn::kLongestSafetensorsHeader) return CheckpointFormat::safetensors;
  }
  if (text.starts_with("PK\x03\x04") || text.starts_with("PK\x05\x06")) return CheckpointFormat::pytorch_zip;
  if (begins_like_a_pickle(bytes)) return CheckpointFormat::pytorch_legacy;
  if (has_brace) return CheckpointFormat::safetensors;  // its reader says what is wrong with the length
  throw InputError(
      place, "a safetensors file or a PyTorch checkpoint",
      bytes.empty() ? "an empty file" : "a file that begins with '" + printable(text.substr(0, 16)) + "'");
}

// Of safetensors names "KEY.NAME" the NAMEs.
void take_key(nn::StateDict& state, std::string_view key) {
  const std::string prefix = std::string(key) + ".";
  std::map<std::string, nn::StoredTensor> tensors;
  for (auto& [name, tensor] : state.tensors) {
    if (name.starts_with(prefix) && name.size() > prefix.size()) {
      tensors.emplace(name.substr(prefix.size()), std::move(tensor));
    }
  }
  if (tensors.empty()) {
    throw InputError(state.source, fmt::format("names that begin with '{}'", printable(prefix)),
                     fmt::format("none among {} tensors", state.tensors.size()));
  }
  state.tensors = std::move(tensors);
}

nn::StateDict read(const std::filesystem::path& path, std::string_view key) {
  const std::shared_ptr<const MappedFile> file = MappedFile::open(path);
  const std::string place = path.string();
  switch (recognise(file->bytes(), place)) {
    case CheckpointFormat::safetensors: {
      nn::StateDict state = nn::read_safetensors(path);
      if (!key.empty()) take_key(state, key);
      return state;
    }
    case CheckpointFormat::pytorch_zip:
      return read_torch_zip(file, place, key);
    case CheckpointFormat::pytorch_legacy:
      return read_torch_legacy(file, place, key);
  }
  return {};
}

}  // namespace

const char* to_string(CheckpointFormat format) {
  switch (format) {
    case CheckpointFormat::safetensors:
      return "safetensors";
    case CheckpointFormat::pytorch_zip:
      return "pytorch-zip";
    case CheckpointFormat::pytorch_legacy:
      return "pytorch-legacy";
  }
  return "?";
}

CheckpointFormat checkpoint_format(const std::filesystem::path& path) {
  return recognise(MappedFile::open(path)->bytes(), path.string());
}

nn::StateDict load_weights(const std::filesystem::path& path, std::string_view key) {
  nn::StateDict state = read(path, key);
  if (state.tensors.empty()) throw InputError(path.string(), "a checkpoint with tensors", "0 tensors");
  unwrap_names(state);
  return state;
}

}  // namespace penumbra::weights_tools
