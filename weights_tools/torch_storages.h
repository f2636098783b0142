// From a checkpoint's storages to contiguous tensors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "nn/io/state_dict.h"
#include "weights_tools/pickle_value.h"
#include "weights_tools/torch_state_dict.h"

namespace penumbra::weights_tools {

// How much memory a file may take beyond its own bytes: what it inflates to and what its expanded or
// transposed tensors take when they are written out. A file of a few bytes may claim any size for both.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::size_t file_size) : left_(kFree + kPerFileByte * std::uint64_t{file_size}) {}

  // Throws InputError where less than `bytes` are left.
  void take(std::uint64_t bytes, const std::string& place);

 private:
  static constexpr std::uint64_t kFree = 256U << 20;
  static constexpr std::uint64_t kPerFileByte = 8;
  std::uint64_t left_;
};

// A buffer that is not zeroed first.
std::shared_ptr<std::byte[]> make_buffer(std::size_t size);

// The tensors of which the storages are needed: all, and the strides.
std::vector<const TorchTensor*> tensors_to_read(const TorchState& torch);

// Adds tensors, metadata and notes to `state`. Where the elements lie contiguously in the storage the tensor
// views them; otherwise (transposed, expanded, every other one ...) they are copied into a buffer of their
// own, which `state` owns. `storages` holds, for each of object.storages that a tensor uses, all of its
// bytes.
void add_state(const PickledObject& object, TorchState torch,
               const std::vector<std::span<const std::byte>>& storages, MemoryBudget& budget,
               nn::StateDict& state);

}  // namespace penumbra::weights_tools
