#include "slam/sources/bag/packed_file.h"

#include <algorithm>
#include <numeric>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::slam {

namespace {

constexpr std::size_t kMostKept = std::size_t{64} << 20;  // bytes of unpacked chunks, beside the last
constexpr std::uint64_t kForgottenAtOnce = std::uint64_t{16} << 20;  // bytes

}  // namespace

PackedFile::PackedFile(const std::filesystem::path& path)
    : name_(printable(path.string(), 400)), file_(MappedFile::open(path)) {
  const std::span<const std::byte> all = file_->bytes();
  bytes_ = {reinterpret_cast<const char*>(all.data()), all.size()};
}

std::string PackedFile::place(std::uint64_t byte) const { return fmt::format("{}, byte {}", name_, byte); }

std::string_view PackedFile::part(std::uint64_t at, std::uint64_t size) const {
  if (at > bytes_.size() || size > bytes_.size() - at)
    throw InputError(place(at), fmt::format("{} bytes", size), fmt::format("the end at {}", bytes_.size()));
  return bytes_.substr(at, size);
}

std::string_view PackedFile::chunk(std::uint64_t at, const std::function<std::string()>& unpack) {
  const auto found =
      std::find_if(chunks_.begin(), chunks_.end(), [&](const Chunk& chunk) { return chunk.at == at; });
  if (found != chunks_.end()) {
    std::rotate(found, found + 1, chunks_.end());
    return chunks_.back().bytes;
  }
  Chunk chunk{at, unpack()};
  std::size_t kept = 0;
  for (const Chunk& other : chunks_) kept += other.bytes.size();
  while (!chunks_.empty() && kept + chunk.bytes.size() > kMostKept) {
    kept -= chunks_.front().bytes.size();
    chunks_.erase(chunks_.begin());
  }
  chunks_.push_back(std::move(chunk));
  return chunks_.back().bytes;
}

void PackedFile::forget(std::string_view part) const { file_->forget(std::as_bytes(std::span(part))); }

void PackedFile::forget_before(std::uint64_t end) {
  if (end < forgotten_ + kForgottenAtOnce) return;
  file_->forget(file_->bytes().subspan(forgotten_, end - forgotten_));
  forgotten_ = end;
}

}  // namespace penumbra::slam
