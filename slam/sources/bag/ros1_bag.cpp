#include "slam/sources/bag/ros1_bag.h"

#include <cstring>
#include <map>
#include <optional>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/text.h"
#include "slam/sources/bag/chunk_packing.h"
#include "slam/sources/bag/chunked_source.h"

namespace penumbra::slam {

namespace {

constexpr std::string_view kVersion = "#ROSBAG V2.0\n";

template <class T>
std::optional<T> number_in(std::string_view bytes) {
  T value{};
  if (bytes.size() != sizeof(T)) return std::nullopt;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

// Takes a piece with its length before it off the front; none where it is not whole.
std::optional<std::string_view> take_piece(std::string_view& bytes) {
  const std::optional<std::uint32_t> length =
      number_in<std::uint32_t>(bytes.substr(0, sizeof(std::uint32_t)));
  if (!length || *length > bytes.size() - sizeof(*length)) return std::nullopt;
  const std::string_view piece = bytes.substr(sizeof(*length), *length);
  bytes.remove_prefix(sizeof(*length) + *length);
  return piece;
}

// The value of a field "name=value" of a header; empty where there is none.
std::string_view field(std::string_view header, std::string_view name) {
  while (const std::optional<std::string_view> piece = take_piece(header)) {
    if (piece->size() > name.size() && piece->starts_with(name) && (*piece)[name.size()] == '=')
      return piece->substr(name.size() + 1);
  }
  return {};
}

enum class Op { message = 2, bag = 3, index = 4, chunk = 5, chunk_info = 6, connection = 7 };

struct Record {
  std::string_view header, data;

  std::optional<Op> op() const {
    const std::optional<std::uint8_t> value = number_in<std::uint8_t>(field(header, "op"));
    if (!value || *value < 2 || *value > 7) return std::nullopt;
    return static_cast<Op>(*value);
  }
};

// Takes a record off the front; none, and nothing taken, where it is not whole.
std::optional<Record> take_record(std::string_view& bytes) {
  std::string_view rest = bytes;
  const std::optional<std::string_view> header = take_piece(rest);
  if (!header) return std::nullopt;
  const std::optional<std::string_view> data = take_piece(rest);
  if (!data) return std::nullopt;
  bytes = rest;
  return Record{*header, *data};
}

class Ros1Bag final : public ChunkedSource {
 public:
  explicit Ros1Bag(const std::filesystem::path& path) : ChunkedSource(path) {
    if (!file_.bytes().starts_with(kVersion)) {
      throw InputError(file_.name(), "a ROS 1 bag of version 2.0",
                       fmt::format("'{}'", printable(file_.bytes().substr(0, file_.bytes().find('\n')), 20)));
    }
  }

  std::string kind() const override { return "ROS 1 bag"; }

  void read_all(const Take& take) override {
    std::string_view rest = file_.bytes().substr(kVersion.size());
    bool is_whole = true;
    std::uint64_t index_at = 0;
    while (!rest.empty()) {
      const std::uint64_t at = byte_of(rest);
      const std::optional<Record> record = take_record(rest);
      const std::optional<Op> op = record ? record->op() : std::nullopt;
      if (!op) {
        note_cut(at);
        is_whole = false;
        break;
      }
      if (*op == Op::bag) {
        index_at = number_in<std::uint64_t>(field(record->header, "index_pos")).value_or(0);
        const std::string_view encryptor = field(record->header, "encryptor");
        if (!encryptor.empty())
          throw InputError(file_.name(), "a bag that is not encrypted", printable(encryptor, 60));
      } else if (*op == Op::chunk) {
        const Packing packing = packing_named(field(record->header, "compression"), file_.place(at));
        require_packing(packing, file_.name());
        ++chunks_;
        use([&] { read_chunk(*record, at, packing, take); });
      } else {
        use([&] { read_record(*record, *op, std::nullopt, take); });
      }
      file_.forget_before(byte_of(rest));
    }
    if (is_whole && (index_at == 0 || index_at >= file_.bytes().size())) {
      notes_.push_back(fmt::format("{}: {}, so it has no index; used: {} with {}, all that there are",
                                   file_.name(),
                                   index_at == 0 ? "its recorder did not finish it" : "its end is missing",
                                   counted(chunks_, "chunk"), counted(messages_, "message")));
    }
    note_damage();
  }

 private:
  std::string unpack_at(std::uint64_t at) const override {
    std::string_view rest = from(at);
    const std::optional<Record> record = take_record(rest);
    if (!record) throw InputError(file_.place(at), "a chunk", "none any more");
    std::string bytes = unpack(*record, at);
    file_.forget(record->data);
    return bytes;
  }

  std::string unpack(const Record& record, std::uint64_t at) const {
    const std::string place = file_.place(at);
    const Packing packing = packing_named(field(record.header, "compression"), place);
    return unpack_chunk(record.data, packing,
                        number_in<std::uint32_t>(field(record.header, "size")).value_or(0), place);
  }

  void read_chunk(const Record& record, std::uint64_t at, Packing packing, const Take& take) {
    if (packing == Packing::none) {
      read_records(record.data, std::nullopt, take);
    } else {
      const std::string chunk = unpack(record, at);
      read_records(chunk, Inside{at, chunk}, take);
    }
  }

  void read_records(std::string_view rest, const std::optional<Inside>& inside, const Take& take) {
    while (!rest.empty()) {
      const std::optional<Record> record = take_record(rest);
      const std::optional<Op> op = record ? record->op() : std::nullopt;
      if (!op) throw InputError(file_.name(), "whole records in a chunk", "others");
      read_record(*record, *op, inside, take);
    }
  }

  void read_record(const Record& record, Op op, const std::optional<Inside>& inside, const Take& take) {
    if (op != Op::connection && op != Op::message) return;
    const auto connection = number_in<std::uint32_t>(field(record.header, "conn"));
    if (!connection) throw InputError(file_.name(), "the number of a connection", "none");
    if (op == Op::connection) {
      topics_by_connection_[*connection] =
          topic_place(field(record.header, "topic"), field(record.data, "type"), "ros1");
      return;
    }
    const auto topic = topics_by_connection_.find(*connection);
    const std::string_view time = field(record.header, "time");  // seconds, nanoseconds
    const auto seconds = number_in<std::uint32_t>(time.substr(0, 4));
    const auto nanoseconds = number_in<std::uint32_t>(time.substr(std::min<std::size_t>(4, time.size())));
    if (topic == topics_by_connection_.end() || !seconds || !nanoseconds)
      throw InputError(file_.name(), "a message of a connection, with its time", "another");
    hand_on(topic->second, std::int64_t{*seconds} * 1'000'000'000 + *nanoseconds, record.data, inside, take);
  }

  std::map<std::uint32_t, std::size_t> topics_by_connection_;
};

}  // namespace

std::unique_ptr<MessageSource> open_ros1_bag(const std::filesystem::path& path) {
  return std::make_unique<Ros1Bag>(path);
}

}  // namespace penumbra::slam
