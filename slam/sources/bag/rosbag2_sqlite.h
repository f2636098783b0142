// rosbag2's SQLite files (.db3): the tables topics(id, name, type, serialization_format) and
// messages(topic_id, timestamp, data).
//
// Read by the library sqlite3, which is optional; the file is opened as one that nobody writes to.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "slam/sources/bag/message_source.h"

namespace penumbra::slam {

inline constexpr std::string_view kSqliteBegins = "SQLite format 3";

// Throws InputError where this build has no sqlite3, and where the file has no such tables.
std::unique_ptr<MessageSource> open_rosbag2_sqlite(const std::filesystem::path& path);

}  // namespace penumbra::slam
