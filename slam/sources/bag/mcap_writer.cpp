#include "slam/sources/bag/mcap_writer.h"

#include <fmt/core.h>

#include <algorithm>

#include "nn/base/crc32.h"
#include "slam/sources/bag/mcap.h"

namespace penumbra::slam {

namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

void put_text(ByteWriter& content, std::string_view text) {
  content.put(static_cast<std::uint32_t>(text.size()));
  content.put_array(std::span<const char>(text));
}
void put_map(ByteWriter& content, const std::map<std::uint16_t, std::uint64_t>& map) {
  content.put(static_cast<std::uint32_t>(map.size() * 10));
  for (const auto& [key, value] : map) {
    content.put(key);
    content.put(value);
  }
}
// As rosbag2 keeps what a publisher offered: a YAML list of one profile. Numbers are those of rmw's
// enumerations, which every version reads: keep last, reliable, volatile or transient local, automatic
// liveliness.
std::string quality_of(Offered offered) {
  const bool lasts = offered == Offered::to_late_comers;
  constexpr const char* kEndless = "    sec: 9223372036\n    nsec: 854775807\n";
  return fmt::format(
      "- history: 1\n  depth: {}\n  reliability: 1\n  durability: {}\n  deadline:\n{}  lifespan:\n{}"
      "  liveliness: 1\n  liveliness_lease_duration:\n{}  avoid_ros_namespace_conventions: false",
      lasts ? 1 : 10, lasts ? 1 : 2, kEndless, kEndless, kEndless);
}
std::string mcap_record(McapOp op, std::string_view content) {
  ByteWriter record;
  record.put(op);
  record.put(static_cast<std::uint64_t>(content.size()));
  record.put_array(std::span<const char>(content));
  return record.bytes();
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path) : file_(path) {
  put(kMcapMagic);
  ByteWriter header;
  put_text(header, "ros2");
  put_text(header, "penumbra");
  put_record(McapOp::header, header);
}

void McapWriter::put(std::string_view bytes) {
  file_.write(bytes.data(), bytes.size());
  crc_ = nn::crc32(bytes, crc_);
  position_ += bytes.size();
}

void McapWriter::put_record(McapOp op, const ByteWriter& content) { put(mcap_record(op, content.bytes())); }

std::uint16_t McapWriter::add_channel(std::string_view topic, std::string_view type,
                                      std::string_view definition, Offered offered) {
  const auto id = static_cast<std::uint16_t>(channels_.size() + 1);
  ByteWriter schema, channel;
  schema.put(id);
  put_text(schema, type);
  put_text(schema, "ros2msg");
  put_text(schema, definition);
  channel.put(id);
  channel.put(id);  // its schema
  put_text(channel, topic);
  put_text(channel, "cdr");
  ByteWriter metadata;
  put_text(metadata, "offered_qos_profiles");
  put_text(metadata, quality_of(offered));
  put_text(channel, metadata.bytes());
  schemas_.push_back(schema.bytes());
  channels_.push_back(channel.bytes());
  chunk_ += mcap_record(McapOp::schema, schema.bytes()) + mcap_record(McapOp::channel, channel.bytes());
  return id;
}

void McapWriter::write(std::uint16_t channel, std::int64_t nanoseconds, std::string_view message) {
  const auto time = static_cast<std::uint64_t>(std::max<std::int64_t>(0, nanoseconds));
  const bool is_first = index_.empty();
  first_ = is_first ? time : std::min(first_, time);
  last_ = is_first ? time : std::max(last_, time);
  ByteWriter& index = index_[channel];
  index.put(time);
  index.put(static_cast<std::uint64_t>(chunk_.size()));
  ByteWriter content;
  content.put(channel);
  content.put(static_cast<std::uint32_t>(counts_[channel]++));  // sequence
  content.put(time);
  content.put(time);
  content.put_array(std::span<const char>(message));
  chunk_ += mcap_record(McapOp::message, content.bytes());
  if (chunk_.size() >= kChunkBytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  ChunkIndex chunk;
  chunk.first = first_;
  chunk.last = last_;
  chunk.size = chunk_.size();
  chunk.at = position_;
  ByteWriter content;
  content.put(first_);
  content.put(last_);
  content.put(chunk.size);
  content.put(nn::crc32(chunk_));
  put_text(content, "");
  content.put(chunk.size);
  content.put_array(std::span<const char>(chunk_));
  put_record(McapOp::chunk, content);
  chunk.length = position_ - chunk.at;
  for (const auto& [channel, entries] : index_) {
    chunk.indexes[channel] = position_;
    ByteWriter index;
    index.put(channel);
    put_text(index, entries.bytes());
    put_record(McapOp::message_index, index);
  }
  chunk.index_length = position_ - chunk.at - chunk.length;
  chunks_.push_back(std::move(chunk));
  chunk_.clear();
  index_.clear();
  first_ = last_ = 0;
}

ByteWriter McapWriter::statistics() const {
  std::uint64_t messages = 0, first = 0, last = 0;
  for (const auto& [channel, count] : counts_) messages += count;
  bool is_first = true;
  for (const ChunkIndex& chunk : chunks_) {
    if (chunk.indexes.empty()) continue;
    first = is_first ? chunk.first : std::min(first, chunk.first);
    last = std::max(last, chunk.last);
    is_first = false;
  }
  ByteWriter content;
  content.put(messages);
  content.put(static_cast<std::uint16_t>(schemas_.size()));
  content.put(static_cast<std::uint32_t>(channels_.size()));
  content.put(std::uint32_t{0});  // attachments
  content.put(std::uint32_t{0});  // metadata
  content.put(static_cast<std::uint32_t>(chunks_.size()));
  content.put(first);
  content.put(last);
  put_map(content, counts_);
  return content;
}

void McapWriter::finish() {
  end_chunk();
  ByteWriter end;
  end.put(crc_);
  put_record(McapOp::data_end, end);

  const std::uint64_t summary = position_;
  crc_ = 0;
  std::vector<Group> groups;
  const auto begin = [&](McapOp op) { groups.push_back({op, position_}); };
  begin(McapOp::schema);
  for (const std::string& schema : schemas_) put(mcap_record(McapOp::schema, schema));
  begin(McapOp::channel);
  for (const std::string& channel : channels_) put(mcap_record(McapOp::channel, channel));
  begin(McapOp::statistics);
  put_record(McapOp::statistics, statistics());
  begin(McapOp::chunk_index);
  for (const ChunkIndex& chunk : chunks_) {
    ByteWriter content;
    for (const std::uint64_t value : {chunk.first, chunk.last, chunk.at, chunk.length}) content.put(value);
    put_map(content, chunk.indexes);
    content.put(chunk.index_length);
    put_text(content, "");
    content.put(chunk.size);
    content.put(chunk.size);
    put_record(McapOp::chunk_index, content);
  }
  const std::uint64_t offsets = position_;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const std::uint64_t next = i + 1 < groups.size() ? groups[i + 1].at : offsets;
    if (next == groups[i].at) continue;
    ByteWriter content;
    content.put(groups[i].op);
    content.put(groups[i].at);
    content.put(next - groups[i].at);
    put_record(McapOp::summary_offset, content);
  }
  // The summary's check sum goes as far as the footer's own.
  ByteWriter footer;
  footer.put(McapOp::footer);
  footer.put(std::uint64_t{2 * sizeof(std::uint64_t) + sizeof(std::uint32_t)});
  footer.put(summary);
  footer.put(offsets);
  put(footer.bytes());
  ByteWriter sum;
  sum.put(crc_);
  put(sum.bytes());
  put(kMcapMagic);
  file_.commit();
}

}  // namespace penumbra::slam
