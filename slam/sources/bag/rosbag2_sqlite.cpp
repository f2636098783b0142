#include "slam/sources/bag/rosbag2_sqlite.h"

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/text.h"

#ifdef PENUMBRA_SQLITE
#include <sqlite3.h>

#include <map>
#include <system_error>
#endif

namespace penumbra::slam {

#ifdef PENUMBRA_SQLITE

namespace {

struct Database {
  explicit Database(const std::filesystem::path& path) : name(printable(path.string(), 400)) {
    // A path may hold what means something in a URI.
    std::string uri = "file:";
    for (const char c : std::filesystem::absolute(path).string()) {
      const auto byte = static_cast<unsigned char>(c);
      const bool is_plain = (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'Z') ||
                            (byte >= 'a' && byte <= 'z') || c == '/' || c == '.' || c == '_' || c == '-';
      uri += is_plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
    }
    // A recorder that was killed leaves its last messages in a log beside the file; else nobody writes to it.
    std::error_code error_code;
    const bool has_log = std::filesystem::file_size(path.string() + "-wal", error_code) > 0 && !error_code;
    if (!has_log) uri += "?immutable=1";
    const int result = sqlite3_open_v2(uri.c_str(), &handle,
                                       SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
    if (result != SQLITE_OK) refuse();
    // What is in the file is data: nothing of its schema is to run.
    sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  }
  ~Database() { sqlite3_close(handle); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  std::string error() const {
    return printable(handle == nullptr ? "no memory" : sqlite3_errmsg(handle), 200);
  }
  [[noreturn]] void refuse() const { throw InputError(name, "a recording of rosbag2 (.db3)", error()); }

  std::string name;
  sqlite3* handle = nullptr;
};

class Statement {
 public:
  Statement(const Database& database, const char* sql) : database_(database) {
    if (sqlite3_prepare_v2(database.handle, sql, -1, &statement_, nullptr) != SQLITE_OK) database.refuse();
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  void bind(std::int64_t value) {
    sqlite3_reset(statement_);
    if (sqlite3_bind_int64(statement_, 1, value) != SQLITE_OK) database_.refuse();
  }
  // Whether there is a row; throws InputError where the file is damaged.
  bool step() {
    const int result = sqlite3_step(statement_);
    if (result != SQLITE_ROW && result != SQLITE_DONE) database_.refuse();
    return result == SQLITE_ROW;
  }
  std::int64_t number(int column) { return sqlite3_column_int64(statement_, column); }
  std::string_view bytes(int column) {
    const void* data = sqlite3_column_blob(statement_, column);
    return {static_cast<const char*>(data),
            data == nullptr ? 0 : static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
  }

 private:
  const Database& database_;
  sqlite3_stmt* statement_ = nullptr;
};

class Rosbag2Sqlite final : public MessageSource {
 public:
  explicit Rosbag2Sqlite(const std::filesystem::path& path)
      : database_(path), one_(database_, "SELECT data FROM messages WHERE rowid = ?") {}

  std::string kind() const override { return "rosbag2 SQLite"; }

  void read_all(const Take& take) override {
    std::map<std::int64_t, std::size_t> places;
    Statement topics(database_, "SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    while (topics.step()) {
      const std::int64_t id = topics.number(0);
      const std::string name(topics.bytes(1)), type(topics.bytes(2));
      places[id] = topic_place(name, type, topics.bytes(3));
    }
    std::size_t messages = 0, strangers = 0;
    try {
      Statement rows(database_, "SELECT rowid, topic_id, timestamp, data FROM messages ORDER BY rowid");
      while (rows.step()) {
        const auto topic = places.find(rows.number(1));
        Message message;
        message.bytes = rows.bytes(3);
        if (topic == places.end() || message.bytes.size() >= MessagePlace::kUnpacked) {
          ++strangers;
          continue;
        }
        message.topic = topic->second;
        message.record_time = rows.number(2);
        message.place.at = static_cast<std::uint64_t>(rows.number(0));
        message.place.size = static_cast<std::uint32_t>(message.bytes.size());
        count(message.topic, message.record_time);
        ++messages;
        take(message);
      }
    } catch (const InputError& error) {
      notes_.push_back(
          fmt::format("damaged; used: {} before it: {}", counted(messages, "message"), error.what()));
    }
    if (strangers > 0)
      notes_.push_back(
          fmt::format("{}: left out: {} of no topic", database_.name, counted(strangers, "message")));
  }

  std::string_view read(const MessagePlace& place) override {
    one_.bind(static_cast<std::int64_t>(place.at));
    const std::string_view bytes = one_.step() ? one_.bytes(0) : std::string_view();
    if (bytes.size() != place.size)
      throw InputError(fmt::format("{}, message {}", database_.name, place.at),
                       fmt::format("{} bytes", place.size), fmt::format("{}", bytes.size()));
    return bytes;
  }

 private:
  Database database_;
  Statement one_;
};

}  // namespace

std::unique_ptr<MessageSource> open_rosbag2_sqlite(const std::filesystem::path& path) {
  return std::make_unique<Rosbag2Sqlite>(path);
}

#else

std::unique_ptr<MessageSource> open_rosbag2_sqlite(const std::filesystem::path& path) {
  throw InputError(printable(path.string(), 400),
                   "a build of penumbra with the library sqlite3, which reads .db3 files",
                   "one without (install libsqlite3-dev and build again)");
}

#endif

}  // namespace penumbra::slam
