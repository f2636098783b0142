// What is common to recordings of robots in one file: typed messages on named topics, one after the other.
//
//   ROS 1 bag (ros1_bag.h), MCAP (mcap.h), rosbag2's SQLite (rosbag2_sqlite.h), and a rosbag2 folder of
//   several such files (bag_folder.h)
//
// All are read forward, once, without their index: a recording whose recorder was killed, whose index is
// damaged or whose record times go back gives every message that is whole. Memory does not grow with the
// file: it is mapped, and of what is packed one chunk is unpacked at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra::slam {

// How a message's fields become bytes (message_reader.h); others are only listed.
enum class MessageEncoding { ros1, cdr, other };
MessageEncoding message_encoding(std::string_view name);  // "ros1", "cdr", ...

struct Topic {
  std::string name;      // "/camera/left/image_raw"
  std::string type;      // "sensor_msgs/Image", also where ROS 2 writes "sensor_msgs/msg/Image"
  std::string encoding;  // as the file names it
  // Of the messages read so far; record times in nanoseconds.
  std::uint64_t messages = 0;
  std::int64_t first = 0, last = 0;

  MessageEncoding message_encoding() const { return slam::message_encoding(encoding); }
};

// Where a message lies, so that it can be read again.
struct MessagePlace {
  static constexpr std::uint32_t kUnpacked = 0xFFFFFFFF;

  std::uint64_t at = 0;  // byte in the file: of the message, or of the chunk that it is packed in; or row
  std::uint32_t within = kUnpacked;  // byte in the unpacked chunk
  std::uint32_t size = 0;            // bytes
  std::uint32_t file = 0;            // of a folder's
};

struct Message {
  std::size_t topic = 0;  // place in topics()
  std::int64_t record_time = 0;
  MessagePlace place;
  std::string_view bytes;  // until the next message is read
};

class MessageSource {
 public:
  using Take = std::function<void(const Message&)>;

  virtual ~MessageSource() = default;
  virtual std::string kind() const = 0;  // "ROS 1 bag"
  // Hands on every whole message in the order of the file, and fills topics() and notes(). To be called once.
  // Throws InputError where chunks are packed in a way that this build cannot unpack, and where the file
  // cannot be read at all.
  virtual void read_all(const Take& take) = 0;
  // The bytes of a message, until the next call. Throws InputError where they are not there any more.
  virtual std::string_view read(const MessagePlace& place) = 0;

  const std::vector<Topic>& topics() const { return topics_; }
  // What is to be known of the file: where it was cut off, chunks that are damaged.
  const std::vector<std::string>& notes() const { return notes_; }

 protected:
  // The place of a topic, which is new where it was not there yet with this type.
  std::size_t topic_place(std::string_view name, std::string_view type, std::string_view encoding);
  void count(std::size_t topic, std::int64_t record_time);

  std::vector<Topic> topics_;
  std::vector<std::string> notes_;
};

// By the file's first bytes; or a folder with such files in it. Throws InputError for anything else.
std::unique_ptr<MessageSource> open_bag(const std::filesystem::path& path);
// Whether open_bag would take it.
bool looks_like_bag(const std::filesystem::path& path);

}  // namespace penumbra::slam
