// Writes MCAP files of ROS 2 messages (mcap.h has the format): chunks of about a megabyte, not packed, with
// check sums, index and summary, so that Foxglove and `ros2 bag` open them at any place.
//
// The file is there whole or not at all (nn/base/file_in_the_making.h). Memory: one chunk, and 40 bytes a
// message.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "nn/base/byte_stream.h"
#include "nn/base/file_in_the_making.h"
#include "slam/sources/bag/mcap_records.h"

namespace penumbra::slam {

// To whom a player is to offer a topic's messages again: to who listens when they come, or as "transient
// local" also the last one to who comes later, as of /tf_static and maps.
enum class Offered { as_it_comes, to_late_comers };

class McapWriter {
 public:
  // Throws Error where the file cannot be written, as all functions do.
  explicit McapWriter(const std::filesystem::path& path);

  // A topic of messages in CDR; `definition`: the text of the type and of those that it is made of, as ROS 2
  // has it.
  std::uint16_t add_channel(std::string_view topic, std::string_view type, std::string_view definition,
                            Offered offered = Offered::as_it_comes);
  void write(std::uint16_t channel, std::int64_t nanoseconds, std::string_view message);
  void finish();

 private:
  struct ChunkIndex {
    std::uint64_t first = 0, last = 0, at = 0, length = 0, index_length = 0, size = 0;
    std::map<std::uint16_t, std::uint64_t> indexes;  // where each channel's message index lies
  };
  struct Group {
    McapOp op;
    std::uint64_t at;
  };

  void put(std::string_view bytes);
  void put_record(McapOp op, const ByteWriter& content);
  void end_chunk();
  ByteWriter statistics() const;

  nn::FileInTheMaking file_;
  std::uint64_t position_ = 0;
  std::uint32_t crc_ = 0;                        // of the bytes since it was last set to 0
  std::vector<std::string> schemas_, channels_;  // records' contents; the number is the place + 1
  std::string chunk_;
  std::uint64_t first_ = 0, last_ = 0;         // nanoseconds, of the chunk
  std::map<std::uint16_t, ByteWriter> index_;  // of the chunk
  std::map<std::uint16_t, std::uint64_t> counts_;
  std::vector<ChunkIndex> chunks_;
};

}  // namespace penumbra::slam
