// What ROS 1 bags and MCAP files have in common: records one after the other, some in packed chunks.
#pragma once

#include <optional>

#include "nn/base/error.h"
#include "slam/sources/bag/message_source.h"
#include "slam/sources/bag/packed_file.h"

namespace penumbra::slam {

class ChunkedSource : public MessageSource {
 public:
  explicit ChunkedSource(const std::filesystem::path& path) : file_(path) {}

  std::string_view read(const MessagePlace& place) override;

 protected:
  // The unpacked chunk that a message comes from; none: it lies in the file itself.
  struct Inside {
    std::uint64_t at;
    std::string_view bytes;
  };

  // The records of the chunk at byte `at`.
  virtual std::string unpack_at(std::uint64_t at) const = 0;

  // Where in the file the bytes lie that are next.
  std::uint64_t byte_of(std::string_view rest) const {
    return static_cast<std::uint64_t>(rest.data() - file_.bytes().data());
  }
  std::string_view from(std::uint64_t at) const { return file_.part(at, file_.bytes().size() - at); }

  void hand_on(std::size_t topic, std::int64_t time, std::string_view data,
               const std::optional<Inside>& inside, const Take& take);
  // What is damaged costs itself alone.
  template <class Read>
  void use(const Read& read) {
    try {
      read();
    } catch (const InputError& error) {
      note_damaged(error);
    }
  }
  void note_cut(std::uint64_t at);
  void note_damage();  // at the end

  PackedFile file_;
  std::size_t chunks_ = 0, messages_ = 0;

 private:
  void note_damaged(const InputError& error);

  std::string_view handed_out_;  // by read(), of the file itself
  std::size_t damaged_ = 0;
  std::string first_damage_;
};

}  // namespace penumbra::slam
