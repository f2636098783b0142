#include "weights_tools/torch_storages.h"

#include <fmt/format.h>

#include <cstring>
#include <limits>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::weights_tools {

namespace {

// Row-major without gaps: stride[d] = product of the extents after d. Strides of extent 1 do not matter.
bool is_contiguous(const TorchTensor& tensor) {
  std::int64_t expected = 1;
  for (std::size_t d = tensor.shape.size(); d-- > 0;) {
    if (tensor.shape[d] == 1) continue;
    if (tensor.stride[d] != expected) return false;
    expected *= tensor.shape[d];
  }
  return true;
}

// Copies the elements in row-major order: the last dimension in the inner loop, the others counted like the
// digits of an odometer.
template <std::size_t kSize>
void copy_strided(const TorchTensor& tensor, const std::byte* storage, std::byte* out) {
  const std::size_t rank = tensor.shape.size();
  const std::int64_t row = tensor.shape[rank - 1], step = tensor.stride[rank - 1];
  std::vector<std::int64_t> index(rank, 0);
  std::int64_t begin = tensor.offset;
  while (true) {
    for (std::int64_t i = 0; i < row; ++i, out += kSize) {
      std::memcpy(out, storage + static_cast<std::size_t>(begin + i * step) * kSize, kSize);
    }
    // The last digit that does not turn over is raised, the ones after it go back to zero.
    std::size_t d = rank - 1;
    while (d > 0 && index[d - 1] + 1 == tensor.shape[d - 1]) {
      --d;
      begin -= index[d] * tensor.stride[d];
      index[d] = 0;
    }
    if (d == 0) return;
    ++index[d - 1];
    begin += tensor.stride[d - 1];
  }
}

void copy_strided(const TorchTensor& tensor, std::size_t size, const std::byte* storage, std::byte* out) {
  switch (size) {
    case 1:
      return copy_strided<1>(tensor, storage, out);
    case 2:
      return copy_strided<2>(tensor, storage, out);
    case 4:
      return copy_strided<4>(tensor, storage, out);
    case 8:
      return copy_strided<8>(tensor, storage, out);
    case 16:
      return copy_strided<16>(tensor, storage, out);
  }
}

constexpr std::size_t kMostStrides = 8;

void add_tensors(const PickledObject& object, const std::vector<TorchTensor>& tensors,
                 const std::vector<std::span<const std::byte>>& storages, MemoryBudget& budget,
                 nn::StateDict& state) {
  for (const TorchTensor& tensor : tensors) {
    const std::span<const std::byte> storage = storages[tensor.storage];
    nn::StoredTensor stored{.type = object.storages[tensor.storage].type, .shape = tensor.shape, .bytes = {}};
    const std::size_t size = nn::size_of(stored.type);  // of the types that PyTorch has: whole bytes
    std::uint64_t bytes = size;
    bool overflows = false;
    for (const std::int64_t extent : tensor.shape) {
      overflows |= __builtin_mul_overflow(bytes, static_cast<std::uint64_t>(extent), &bytes);
    }
    const std::string where = fmt::format("{}: tensor \"{}\"", state.source, printable(tensor.name));
    if (overflows || bytes > std::numeric_limits<std::int64_t>::max()) {
      throw InputError(where, "a size of less than 2^63 bytes",
                       fmt::format("[{}]", fmt::join(tensor.shape, ", ")));
    }
    if (bytes == 0) {
      // nothing to view or to copy
    } else if (is_contiguous(tensor)) {
      stored.bytes = storage.subspan(static_cast<std::size_t>(tensor.offset) * size, bytes);
    } else {
      budget.take(bytes, where);
      const std::shared_ptr<std::byte[]> buffer = make_buffer(bytes);
      copy_strided(tensor, size, storage.data(), buffer.get());
      stored.bytes = {buffer.get(), bytes};
      state.owners.push_back(buffer);
    }
    state.tensors.emplace(tensor.name, std::move(stored));
  }
}

}  // namespace

void MemoryBudget::take(std::uint64_t bytes, const std::string& place) {
  if (bytes > left_) {
    throw InputError(place, "data in proportion to the file's size",
                     fmt::format("{} bytes when unpacked", bytes));
  }
  left_ -= bytes;
}

std::shared_ptr<std::byte[]> make_buffer(std::size_t size) {
  return std::shared_ptr<std::byte[]>(new std::byte[size]);
}

std::vector<const TorchTensor*> tensors_to_read(const TorchState& torch) {
  std::vector<const TorchTensor*> all;
  for (const TorchTensor& tensor : torch.tensors) all.push_back(&tensor);
  if (torch.stride) all.push_back(&*torch.stride);
  return all;
}

void add_state(const PickledObject& object, TorchState torch,
               const std::vector<std::span<const std::byte>>& storages, MemoryBudget& budget,
               nn::StateDict& state) {
  add_tensors(object, torch.tensors, storages, budget, state);
  state.metadata.merge(torch.metadata);
  state.notes = std::move(torch.notes);
  if (!torch.stride) return;
  nn::StateDict strides;
  strides.source = state.source;
  add_tensors(object, {*torch.stride}, storages, budget, strides);
  const nn::StoredTensor& tensor = strides.tensors.begin()->second;
  if (!nn::has_f32_values(tensor.type) || tensor.elements() > static_cast<std::int64_t>(kMostStrides)) return;
  state.metadata["stride"] = fmt::format("{}", fmt::join(tensor.to_f32(), ","));
}

}  // namespace penumbra::weights_tools
