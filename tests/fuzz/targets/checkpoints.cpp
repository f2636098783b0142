// Readers of checkpoints: the pickle machine alone, and whole files of each format.
#include <span>

#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/repair.h"
#include "tests/fuzz/target.h"
#include "weights_tools/load_weights.h"
#include "weights_tools/pickle_machine.h"
#include "weights_tools/torch_state_dict.h"

namespace penumbra::fuzz {

namespace {

// A byte of every page, and the ends: enough to find bytes that are not there.
void touch(std::span<const std::byte> bytes) {
  static volatile unsigned sink = 0;
  for (std::size_t i = 0; i < bytes.size(); i += 4096) sink = sink + static_cast<unsigned>(bytes[i]);
  if (!bytes.empty()) sink = sink + static_cast<unsigned>(bytes.back());
}

bool read_checkpoint(std::string_view bytes) {
  constexpr std::size_t kFewElements = 1U << 16;
  const MemoryFile file(bytes);
  return is_read([&] {
    for (const auto& [name, tensor] : weights_tools::load_weights(file.path()).tensors) {
      const auto elements = static_cast<std::size_t>(tensor.elements());
      require(tensor.bytes.size() == nn::bytes_of(tensor.type, elements),
              "a tensor has the bytes of its shape");
      touch(tensor.bytes);
      if (elements <= kFewElements && nn::has_f32_values(tensor.type))
        require(tensor.to_f32().size() == elements, "every element is converted");
    }
  });
}

}  // namespace

bool read_pickle(std::string_view bytes) {
  return is_read([&] {
    const weights_tools::PickledObject object =
        weights_tools::run_pickle(std::as_bytes(std::span(bytes)), 0, "pickle");
    require(object.end <= bytes.size(), "a pickle ends within its bytes");
    for (const weights_tools::TorchTensor& tensor :
         weights_tools::find_state_dict(object, "pickle").tensors) {
      // The largest index, in arithmetic that cannot overflow, against the storage's size.
      long double last = static_cast<long double>(tensor.offset), elements = 1.0L;
      for (std::size_t d = 0; d < tensor.shape.size(); ++d) {
        elements *= static_cast<long double>(tensor.shape[d]);
        last += static_cast<long double>(tensor.shape[d] - 1) * static_cast<long double>(tensor.stride[d]);
      }
      const auto stored = static_cast<long double>(object.storages.at(tensor.storage).elements);
      require(elements == 0.0L || last < stored, "a tensor's indices lie in its storage");
    }
  });
}

bool read_torch_zip(std::string_view bytes) {
  const bool is_whole = read_checkpoint(bytes);
  return read_checkpoint(repair_zip(bytes)) || is_whole;
}

bool read_torch_legacy(std::string_view bytes) { return read_checkpoint(bytes); }

bool read_safetensors(std::string_view bytes) { return read_checkpoint(bytes); }

}  // namespace penumbra::fuzz
