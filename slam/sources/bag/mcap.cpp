#include "slam/sources/bag/mcap.h"

#include <limits>
#include <map>

#include "nn/base/counted.h"
#include "nn/base/crc32.h"
#include "nn/base/text.h"
#include "slam/sources/bag/chunk_packing.h"
#include "slam/sources/bag/chunked_source.h"
#include "slam/sources/bag/mcap_records.h"

namespace penumbra::slam {

namespace {

struct Chunk {
  std::uint64_t size = 0;  // unpacked
  std::uint32_t crc = 0;   // 0: not given
  std::string_view packing, records;

  Chunk(std::string_view content, std::string_view place) {
    McapFields fields(content, place);
    fields.number<std::uint64_t>();  // first
    fields.number<std::uint64_t>();  // and last log time
    size = fields.number<std::uint64_t>();
    crc = fields.number<std::uint32_t>();
    packing = fields.text();
    records = fields.take(fields.number<std::uint64_t>());
  }
};

class Mcap final : public ChunkedSource {
 public:
  explicit Mcap(const std::filesystem::path& path) : ChunkedSource(path) {
    if (!file_.bytes().starts_with(kMcapMagic)) {
      throw InputError(file_.name(), "an MCAP file of version 0",
                       fmt::format("'{}'", printable(file_.bytes().substr(0, kMcapMagic.size()), 40)));
    }
  }

  std::string kind() const override { return "MCAP"; }

  void read_all(const Take& take) override {
    std::string_view rest = file_.bytes().substr(kMcapMagic.size());
    std::uint32_t crc = nn::crc32(kMcapMagic);
    bool is_ended = false;
    while (!is_ended) {
      const std::uint64_t at = byte_of(rest);
      const std::optional<McapRecord> record = take_mcap_record(rest);
      if (!record || record->op == McapOp{0}) {
        note_cut(at);
        break;
      }
      if (record->op == McapOp::data_end) {
        is_ended = true;
        use([&] { check_end(record->content, crc, rest); });
      } else if (record->op == McapOp::chunk) {
        ++chunks_;
        std::optional<Chunk> chunk;
        use([&] { chunk.emplace(record->content, file_.place(at)); });
        if (chunk) {
          require_packing(packing_named(chunk->packing, file_.place(at)), file_.name());
          use([&] { read_chunk(*chunk, at, take); });
        }
      } else {
        use([&] { read_record(*record, std::nullopt, take); });
      }
      crc = nn::crc32(file_.part(at, byte_of(rest) - at), crc);
      file_.forget_before(byte_of(rest));
    }
    note_damage();
  }

 private:
  std::string unpack_at(std::uint64_t at) const override {
    std::string_view rest = from(at);
    const std::optional<McapRecord> record = take_mcap_record(rest);
    if (!record) throw InputError(file_.place(at), "a chunk", "none any more");
    std::string bytes = unpack(Chunk(record->content, file_.name()), at);
    file_.forget(record->content);
    return bytes;
  }

  std::string unpack(const Chunk& chunk, std::uint64_t at) const {
    const std::string place = file_.place(at);
    const Packing packing = packing_named(chunk.packing, place);
    std::string bytes = unpack_chunk(chunk.records, packing, chunk.size, place);
    check_crc(bytes, chunk.crc, place);
    return bytes;
  }

  static void check_crc(std::string_view bytes, std::uint32_t crc, std::string_view place) {
    if (crc == 0) return;
    const std::uint32_t found = nn::crc32(bytes);
    if (found != crc)
      throw InputError(place, fmt::format("CRC-32 {:08x}", crc), fmt::format("{:08x}", found));
  }

  void read_chunk(const Chunk& chunk, std::uint64_t at, const Take& take) {
    if (packing_named(chunk.packing, file_.place(at)) == Packing::none) {
      if (chunk.size != chunk.records.size())
        throw InputError(file_.place(at), fmt::format("a chunk of {} bytes", chunk.size),
                         fmt::format("{}", chunk.records.size()));
      check_crc(chunk.records, chunk.crc, file_.place(at));
      read_records(chunk.records, std::nullopt, take);
    } else {
      const std::string bytes = unpack(chunk, at);
      read_records(bytes, Inside{at, bytes}, take);
    }
  }

  void read_records(std::string_view rest, const std::optional<Inside>& inside, const Take& take) {
    while (!rest.empty()) {
      const std::optional<McapRecord> record = take_mcap_record(rest);
      if (!record) throw InputError(file_.name(), "whole records in a chunk", "others");
      read_record(*record, inside, take);
    }
  }

  void read_record(const McapRecord& record, const std::optional<Inside>& inside, const Take& take) {
    McapFields fields(record.content, file_.name());
    if (record.op == McapOp::schema) {
      const auto id = fields.number<std::uint16_t>();
      types_[id] = fields.text();
    } else if (record.op == McapOp::channel) {
      const auto id = fields.number<std::uint16_t>(), schema = fields.number<std::uint16_t>();
      const std::string_view topic = fields.text(), encoding = fields.text();
      const auto type = types_.find(schema);
      channels_[id] =
          topic_place(topic, type == types_.end() ? "" : std::string_view(type->second), encoding);
    } else if (record.op == McapOp::message) {
      read_message(fields, inside, take);
    }
  }

  void read_message(McapFields& fields, const std::optional<Inside>& inside, const Take& take) {
    const auto channel = channels_.find(fields.number<std::uint16_t>());
    if (channel == channels_.end()) throw InputError(file_.name(), "the message of a channel", "another's");
    fields.number<std::uint32_t>();  // sequence
    const auto time = fields.number<std::uint64_t>();
    fields.number<std::uint64_t>();  // publish time
    const auto latest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    hand_on(channel->second, static_cast<std::int64_t>(std::min(time, latest)), fields.rest(), inside, take);
  }

  // `crc`: of all before the data's end; `rest`: what is behind it.
  void check_end(std::string_view content, std::uint32_t crc, std::string_view rest) {
    const auto expected = McapFields(content, file_.name()).number<std::uint32_t>();
    if (!rest.ends_with(kMcapMagic)) {
      notes_.push_back(fmt::format("{}: its end is missing; used: {}, all that there are", file_.name(),
                                   counted(messages_, "message")));
    }
    if (expected == 0 || expected == crc) return;
    notes_.push_back(fmt::format("{}: the check sum of its data is wrong: what is in no chunk may be damaged",
                                 file_.name()));
  }

  std::map<std::uint16_t, std::string> types_;
  std::map<std::uint16_t, std::size_t> channels_;
};

}  // namespace

std::unique_ptr<MessageSource> open_mcap(const std::filesystem::path& path) {
  return std::make_unique<Mcap>(path);
}

}  // namespace penumbra::slam
