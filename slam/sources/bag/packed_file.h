// A file of which parts are packed: mapped, with the chunks that were last unpacked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "nn/base/mapped_file.h"

namespace penumbra::slam {

class PackedFile {
 public:
  explicit PackedFile(const std::filesystem::path& path);  // throws InputError as MappedFile::open does

  const std::string& name() const { return name_; }
  std::string_view bytes() const { return bytes_; }
  std::string place(std::uint64_t byte) const;  // for messages

  // Throws InputError where they are not in the file.
  std::string_view part(std::uint64_t at, std::uint64_t size) const;
  // The chunk at byte `at`, from the last few or by `unpack`; until the next call.
  std::string_view chunk(std::uint64_t at, const std::function<std::string()>& unpack);
  // What lies before byte `end`, or in a part, will not be read again soon: the process need not hold it.
  void forget_before(std::uint64_t end);
  void forget(std::string_view part) const;

 private:
  struct Chunk {
    std::uint64_t at = 0;
    std::string bytes;
  };

  std::string name_;
  std::shared_ptr<const MappedFile> file_;
  std::string_view bytes_;
  std::uint64_t forgotten_ = 0;  // bytes from the beginning
  std::vector<Chunk> chunks_;    // the last used at the end
};

}  // namespace penumbra::slam
