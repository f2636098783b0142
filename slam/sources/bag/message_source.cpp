#include "slam/sources/bag/message_source.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>

#include "nn/base/error.h"
#include "slam/sources/bag/bag_folder.h"
#include "slam/sources/bag/mcap.h"
#include "slam/sources/bag/ros1_bag.h"
#include "slam/sources/bag/rosbag2_sqlite.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

struct Kind {
  std::string_view begins;
  std::unique_ptr<MessageSource> (*open)(const fs::path&);
};
constexpr Kind kKinds[] = {
    {kRos1BagBegins, open_ros1_bag},
    {kMcapBegins, open_mcap},
    {kSqliteBegins, open_rosbag2_sqlite},
};

std::string first_bytes(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return {};
  std::array<char, 16> bytes{};
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), bytes.size());
  return {bytes.data(), static_cast<std::size_t>(file.gcount())};
}

const Kind* kind_of(const fs::path& path) {
  const std::string bytes = first_bytes(path);
  const auto found = std::find_if(std::begin(kKinds), std::end(kKinds),
                                  [&](const Kind& kind) { return bytes.starts_with(kind.begins); });
  return found == std::end(kKinds) ? nullptr : found;
}

// "sensor_msgs/msg/Image" of ROS 2 is "sensor_msgs/Image" of ROS 1.
std::string plain_type(std::string_view type) {
  constexpr std::string_view kMiddle = "/msg/";
  std::string plain(type);
  const std::size_t at = plain.find(kMiddle);
  if (at != std::string::npos) plain.erase(at, kMiddle.size() - 1);
  return plain;
}

}  // namespace

MessageEncoding message_encoding(std::string_view name) {
  if (name == "ros1") return MessageEncoding::ros1;
  if (name == "cdr") return MessageEncoding::cdr;
  return MessageEncoding::other;
}

std::size_t MessageSource::topic_place(std::string_view name, std::string_view type,
                                       std::string_view encoding) {
  constexpr std::size_t kMostTopics = 10'000;
  const std::string plain = plain_type(type);
  const auto is_it = [&](const Topic& t) {
    return t.name == name && t.type == plain && t.encoding == encoding;
  };
  const auto found = std::find_if(topics_.begin(), topics_.end(), is_it);
  if (found != topics_.end()) return static_cast<std::size_t>(found - topics_.begin());
  if (topics_.size() >= kMostTopics)
    throw InputError("recording", fmt::format("at most {} topics", kMostTopics), "more");
  topics_.push_back({std::string(name), plain, std::string(encoding)});
  return topics_.size() - 1;
}

void MessageSource::count(std::size_t place, std::int64_t record_time) {
  Topic& topic = topics_[place];
  topic.first = topic.messages == 0 ? record_time : std::min(topic.first, record_time);
  topic.last = topic.messages == 0 ? record_time : std::max(topic.last, record_time);
  ++topic.messages;
}

bool looks_like_bag(const fs::path& path) { return kind_of(path) != nullptr || is_bag_folder(path); }

std::unique_ptr<MessageSource> open_bag(const fs::path& path) {
  if (const Kind* kind = kind_of(path)) return kind->open(path);
  if (is_bag_folder(path)) return open_bag_folder(path);
  throw InputError(path.string(),
                   "a recording: a ROS 1 bag, an MCAP file, a .db3 of rosbag2, or rosbag2's folder",
                   "something else");
}

}  // namespace penumbra::slam
