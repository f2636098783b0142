#include "tests/support/bag_files.h"

#include <map>

#include "nn/base/crc32.h"

namespace penumbra::test {

std::string image_message(Wire wire, const ImageParts& image) {
  MessageBytes bytes(wire);
  bytes.header(image.stamp, image.frame).number(image.height).number(image.width).text(image.encoding);
  bytes.number(static_cast<std::uint8_t>(image.is_big_endian)).number(image.step).list(image.data);
  return bytes.bytes();
}

std::string compressed_message(Wire wire, std::int64_t stamp, const std::string& format,
                               const std::string& data) {
  return MessageBytes(wire).header(stamp, "camera").text(format).list(data).bytes();
}

CameraParts pinhole(std::uint32_t width, std::uint32_t height, double f, double Tx) {
  CameraParts camera;
  camera.width = width;
  camera.height = height;
  const double cx = width / 2.0, cy = height / 2.0;
  camera.K = {f, 0, cx, 0, f, cy, 0, 0, 1};
  camera.P = {f, 0, cx, Tx, 0, f, cy, 0, 0, 0, 1, 0};
  return camera;
}

std::string transforms_message(Wire wire, const std::vector<TransformParts>& transforms) {
  MessageBytes bytes(wire);
  bytes.number(static_cast<std::uint32_t>(transforms.size()));
  for (const TransformParts& transform : transforms) {
    bytes.header(0, transform.parent).text(transform.child);
    bytes.numbers(transform.at).numbers(transform.rotation);
  }
  return bytes.bytes();
}

std::string camera_message(Wire wire, const CameraParts& camera) {
  MessageBytes bytes(wire);
  bytes.header(1, camera.frame).number(camera.height).number(camera.width).text(camera.model);
  bytes.number(static_cast<std::uint32_t>(camera.D.size())).numbers(camera.D);
  bytes.numbers(camera.K).numbers(camera.R).numbers(camera.P);
  for (const std::uint32_t value : camera.binning_and_roi) bytes.number(value);
  return bytes.number(std::uint8_t{0}).bytes();
}

namespace {

std::string with_length(const std::string& bytes) {
  return little_endian(static_cast<std::uint32_t>(bytes.size())) + bytes;
}

// A record of a ROS 1 bag.
std::string ros1_record(std::initializer_list<std::pair<const char*, std::string>> fields,
                        const std::string& data) {
  std::string header;
  for (const auto& [name, value] : fields) header += with_length(std::string(name) + "=" + value);
  return with_length(header) + with_length(data);
}
std::string op(int value) { return std::string(1, static_cast<char>(value)); }

std::string mcap_record(int code, const std::string& content) {
  return op(code) + little_endian(static_cast<std::uint64_t>(content.size())) + content;
}

}  // namespace

std::string ros1_bag(const std::vector<BagMessage>& messages, std::size_t per_chunk, bool is_finished) {
  const auto begin = [](std::uint64_t index_at) {
    return "#ROSBAG V2.0\n" + ros1_record({{"op", op(3)},
                                           {"index_pos", little_endian(index_at)},
                                           {"conn_count", little_endian(std::uint32_t{0})},
                                           {"chunk_count", little_endian(std::uint32_t{0})}},
                                          std::string(1000, ' '));
  };
  std::string bag;
  std::map<std::string, std::uint32_t> connections;
  std::string chunk, known;
  std::size_t in_chunk = 0;
  const auto end_chunk = [&] {
    if (chunk.empty()) return;
    bag += per_chunk == 0 ? chunk
                          : ros1_record({{"op", op(5)},
                                         {"compression", "none"},
                                         {"size", little_endian(static_cast<std::uint32_t>(chunk.size()))}},
                                        chunk);
    if (per_chunk > 0)
      bag += ros1_record({{"op", op(4)}, {"conn", little_endian(std::uint32_t{0})}}, "index");
    chunk.clear();
    in_chunk = 0;
  };
  for (const BagMessage& message : messages) {
    const auto [at, is_new] =
        connections.try_emplace(message.topic, static_cast<std::uint32_t>(connections.size()));
    const std::string connection = little_endian(at->second);
    if (is_new) {
      std::string data;
      for (const std::string& field :
           {"topic=" + message.topic, "type=" + message.type, std::string("md5sum=*")})
        data += with_length(field);
      const std::string record =
          ros1_record({{"op", op(7)}, {"conn", connection}, {"topic", message.topic}}, data);
      chunk += record;
      known += record;
    }
    const std::string time = little_endian(static_cast<std::uint32_t>(message.time / 1'000'000'000)) +
                             little_endian(static_cast<std::uint32_t>(message.time % 1'000'000'000));
    chunk += ros1_record({{"op", op(2)}, {"conn", connection}, {"time", time}}, message.bytes);
    if (++in_chunk == per_chunk) end_chunk();
  }
  end_chunk();
  const std::uint64_t index_at = begin(0).size() + bag.size();
  return is_finished ? begin(index_at) + bag + known : begin(0) + bag;
}

std::string mcap_file(const std::vector<BagMessage>& messages, const std::string& encoding,
                      std::size_t per_chunk, bool is_finished) {
  const std::string magic("\x89MCAP0\r\n", 8);
  std::string file =
      magic + mcap_record(1, with_length(encoding == "cdr" ? "ros2" : encoding) + with_length("test"));
  std::map<std::string, std::uint16_t> channels;
  std::string chunk;
  std::size_t in_chunk = 0;
  const auto end_chunk = [&] {
    if (chunk.empty()) return;
    file += per_chunk == 0
                ? chunk
                : mcap_record(6, little_endian(std::uint64_t{0}) + little_endian(std::uint64_t{0}) +
                                     little_endian(static_cast<std::uint64_t>(chunk.size())) +
                                     little_endian(nn::crc32(chunk)) + with_length("") +
                                     little_endian(static_cast<std::uint64_t>(chunk.size())) + chunk);
    chunk.clear();
    in_chunk = 0;
  };
  for (const BagMessage& message : messages) {
    const auto [at, is_new] =
        channels.try_emplace(message.topic, static_cast<std::uint16_t>(channels.size() + 1));
    const std::string id = little_endian(at->second);
    if (is_new) {
      std::string type = message.type;
      if (encoding == "cdr") type.replace(type.find('/'), 1, "/msg/");
      chunk += mcap_record(3, id + with_length(type) + with_length("") + with_length(""));
      chunk += mcap_record(4, id + id + with_length(message.topic) + with_length(encoding) + with_length(""));
    }
    const std::string time = little_endian(static_cast<std::uint64_t>(message.time));
    chunk += mcap_record(5, id + little_endian(std::uint32_t{0}) + time + time + message.bytes);
    if (++in_chunk == per_chunk) end_chunk();
  }
  end_chunk();
  if (!is_finished) return file;
  file += mcap_record(15, little_endian(nn::crc32(file)));
  return file + mcap_record(2, std::string(20, '\0')) + magic;
}

}  // namespace penumbra::test
