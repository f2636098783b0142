// MCAP files, as ROS 2 records them and Foxglove reads them; messages of ROS 1 and ROS 2.
//
//   magic, then records: u8 opcode, u64 length, content
//     1 header    3 schema: id, name of the type    4 channel: id, schema, topic, encoding of its messages
//     5 message: channel, sequence, log time, publish time, data
//     6 chunk: records 3 to 5, packed by none, lz4 or zstd, with their CRC-32
//    15 the data's end, with the CRC-32 of all before it; behind it a summary and an index, which are not
//    needed
//
// Source: mcap.dev/spec.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "slam/sources/bag/message_source.h"

namespace penumbra::slam {

inline constexpr std::string_view kMcapBegins("\x89MCAP", 5);
inline constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);

// Throws InputError for another version than 0.
std::unique_ptr<MessageSource> open_mcap(const std::filesystem::path& path);

}  // namespace penumbra::slam
