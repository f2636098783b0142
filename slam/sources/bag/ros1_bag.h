// ROS 1 bags, version 2.0.
//
//   "#ROSBAG V2.0\n", then records: u32 length of the header, header, u32 length of the data, data
//   header: fields "u32 length, name=value", of which op says what the record is:
//     3 the bag's own (index_pos: 0 where the recorder did not finish)      7 a connection: topic, type
//     5 a chunk: records of op 7 and 2, packed by none, bz2 or lz4          2 a message: connection, time
//     4 and 6 the index, which is not needed
//
// Source: wiki.ros.org/Bags/Format/2.0.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "slam/sources/bag/message_source.h"

namespace penumbra::slam {

inline constexpr std::string_view kRos1BagBegins = "#ROSBAG V";

// Throws InputError for another version, and for an encrypted bag.
std::unique_ptr<MessageSource> open_ros1_bag(const std::filesystem::path& path);

}  // namespace penumbra::slam
