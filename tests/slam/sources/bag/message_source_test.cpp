// ROS 1 bags, MCAP and rosbag2's SQLite: what is in them, also where they are torn, and where their parts are
// packed.
#include "slam/sources/bag/message_source.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <memory>

#include "nn/base/error.h"
#include "slam/sources/bag/chunk_packing.h"
#include "tests/support/bag_files.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

namespace fs = std::filesystem;
using test::BagMessage;
using test::expect_error;

// What a file gives: each message's topic, time and bytes, and that it reads the same again by its place.
struct Found {
  std::vector<BagMessage> messages;
  std::vector<Topic> topics;
  std::vector<std::string> notes;
};

Found read(const fs::path& path) {
  const std::unique_ptr<MessageSource> source = open_bag(path);
  Found found;
  std::vector<MessagePlace> places;
  source->read_all([&](const Message& message) {
    const Topic& topic = source->topics()[message.topic];
    found.messages.push_back({topic.name, topic.type, message.record_time, std::string(message.bytes)});
    places.push_back(message.place);
  });
  for (std::size_t i = places.size(); i-- > 0;) {
    EXPECT_EQ(source->read(places[i]), found.messages[i].bytes) << i;
  }
  found.topics = source->topics();
  found.notes = source->notes();
  return found;
}

// Eight messages on two topics, whose times go back in the middle.
std::vector<BagMessage> eight_messages() {
  std::vector<BagMessage> messages;
  for (int i = 0; i < 8; ++i) {
    const std::int64_t time = (i < 4 ? 100 + i : 50 + i) * std::int64_t{1'000'000'000} + i;
    messages.push_back({i % 2 == 0 ? "/left" : "/right", "std_msgs/String", time,
                        std::string(100, static_cast<char>('a' + i))});
  }
  return messages;
}

void expect_messages(const Found& found, std::size_t count) {
  const std::vector<BagMessage> expected = eight_messages();
  ASSERT_EQ(found.messages.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(found.messages[i].topic, expected[i].topic) << i;
    EXPECT_EQ(found.messages[i].type, expected[i].type);
    EXPECT_EQ(found.messages[i].time, expected[i].time);
    EXPECT_EQ(found.messages[i].bytes, expected[i].bytes);
  }
}

class BagFileKind : public testing::TestWithParam<std::tuple<bool, std::size_t>> {
 protected:
  std::string file(bool is_finished = true) const {
    const auto [is_mcap, per_chunk] = GetParam();
    return is_mcap ? test::mcap_file(eight_messages(), "cdr", per_chunk, is_finished)
                   : test::ros1_bag(eight_messages(), per_chunk, is_finished);
  }
  Found found_in(const std::string& bytes) const {
    test::write_file(folder_ / "file", bytes);
    return read(folder_ / "file");
  }
  test::TemporaryDirectory folder_;
};

TEST_P(BagFileKind, EveryMessageIsThereInTheOrderOfTheFile) {
  const Found found = found_in(file());
  expect_messages(found, 8);
  EXPECT_TRUE(found.notes.empty()) << found.notes.front();
  ASSERT_EQ(found.topics.size(), 2U);
  EXPECT_EQ(found.topics[0].messages, 4U);
  EXPECT_EQ(found.topics[0].first, 54'000'000'004);
  EXPECT_EQ(found.topics[0].last, 102'000'000'002);
}

TEST_P(BagFileKind, OfAnUnfinishedFileAllThatIsThereIsUsedAndSaid) {
  const Found found = found_in(file(/*is_finished=*/false));
  expect_messages(found, 8);
  ASSERT_EQ(found.notes.size(), 1U);
}

// Cut anywhere: the whole chunks, or the whole messages, before the cut.
TEST_P(BagFileKind, OfATornFileWhatIsWholeIsUsedAndSaid) {
  const std::string whole = file();
  std::size_t before = 0;
  for (std::size_t size = 20; size < whole.size(); size += 13) {
    SCOPED_TRACE(size);
    const Found found = found_in(whole.substr(0, size));
    ASSERT_GE(found.messages.size(), before);
    before = found.messages.size();
    expect_messages(found, before);
    if (before < 8) {
      ASSERT_FALSE(found.notes.empty());
    }
  }
  EXPECT_EQ(before, 8U);
}

TEST_P(BagFileKind, ADamagedFileIsReadOrRefused) {
  const std::string whole = file();
  for (std::size_t at = 0; at < whole.size(); at += 7) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x81);
    test::write_file(folder_ / "file", damaged);
    if (!looks_like_bag(folder_ / "file")) continue;
    try {
      read(folder_ / "file");
    } catch (const InputError&) {
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, BagFileKind,
                         testing::Combine(testing::Bool(), testing::Values(std::size_t{0}, 1, 3, 100)));

TEST(Mcap, AChunkWithAWrongCheckSumIsLeftOutAndSaid) {
  const test::TemporaryDirectory folder;
  std::string bytes = test::mcap_file(eight_messages(), "cdr", 3);
  const std::size_t at = bytes.find(std::string(20, 'd'));  // in the second chunk
  ASSERT_NE(at, bytes.npos);
  bytes[at] = 'x';
  test::write_file(folder / "file", bytes);
  const Found found = read(folder / "file");
  ASSERT_EQ(found.messages.size(), 5U);
  EXPECT_EQ(found.messages[3].bytes[0], 'g');
  ASSERT_EQ(found.notes.size(), 2U);  // the chunk, and the whole
  EXPECT_NE((found.notes[0] + found.notes[1]).find("CRC-32"), std::string::npos);
}

// Megabytes that the process holds.
double resident_megabytes() {
  std::ifstream file("/proc/self/statm");
  long all = 0, resident = 0;
  file >> all >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

// 400 messages of a megabyte, as holes in a file: every byte is looked at, twice, and none is held.
TEST(BagFiles, MemoryDoesNotGrowWithTheFile) {
  constexpr std::size_t kBytes = 1 << 20;
  const test::TemporaryDirectory folder;
  const std::string whole =
      test::mcap_file({{"/left", "std_msgs/String", 0, std::string(8, '\0')}}, "cdr", 0, false);
  const std::size_t record = whole.size() - 39;  // opcode, length, channel, sequence, times, 8 bytes
  std::string message = whole.substr(record, 31);
  message.replace(1, 8, test::little_endian(std::uint64_t{22 + kBytes}));
  {
    std::ofstream file(folder / "file", std::ios::binary);
    file << whole.substr(0, record);
    for (int i = 0; i < 400; ++i) {
      file << message;
      file.seekp(kBytes, std::ios::cur);
    }
    file << std::string("\x0f\4\0\0\0\0\0\0\0\0\0\0\0", 13)
         << whole.substr(0, 8);  // the data's end, without a sum
  }
  const double before = resident_megabytes();
  const std::unique_ptr<MessageSource> source = open_bag(folder / "file");
  std::vector<MessagePlace> places;
  double most = 0.0;
  const auto look = [&](std::string_view bytes) {
    EXPECT_EQ(std::count(bytes.begin(), bytes.end(), '\0'), static_cast<std::ptrdiff_t>(kBytes));
    most = std::max(most, resident_megabytes());
  };
  source->read_all([&](const Message& m) {
    places.push_back(m.place);
    look(m.bytes);
  });
  ASSERT_EQ(places.size(), 400U);
  for (const MessagePlace& place : places) look(source->read(place));
  EXPECT_LT(most - before, 64.0);
}

TEST(BagFiles, OthersAreRefusedByName) {
  const test::TemporaryDirectory folder;
  const auto refused = [&](const std::string& bytes, std::initializer_list<std::string> parts) {
    test::write_file(folder / "file", bytes);
    expect_error<InputError>([&] { read(folder / "file"); }, parts);
  };
  refused("#ROSBAG V1.2\nabc", {"ROS 1 bag of version 2.0", "V1.2"});
  refused(std::string("\x89MCAP9\r\n", 8), {"MCAP file of version 0"});
  refused("hello", {"a ROS 1 bag, an MCAP file"});
  std::string packed = test::ros1_bag(eight_messages());
  packed.replace(packed.find("=none"), 5, "=lzo2");
  refused(packed, {"none, lz4, bz2 or zstd", "'lzo2'"});
}

// Recordings that the real writers made (tests/fixtures/bags/make_bags.py): the same ten messages in each.
class RealWriters : public testing::TestWithParam<const char*> {};

bool has(const std::string& name) {
  for (const BagLibrary& library : bag_libraries()) {
    if (library.name == name) return library.is_there;
  }
  return true;
}

TEST_P(RealWriters, TheirMessagesAreRead) {
  const std::string name = GetParam();
  const std::string needs = name.ends_with(".db3")
                                ? "sqlite3"
                                : name.substr(name.find('_') + 1, name.find('.') - name.find('_') - 1);
  const fs::path path = test::fixture("bags/" + name);
  if (!has(needs)) {
    expect_error<InputError>([&] { read(path); }, {"a build of penumbra with the library " + needs});
    return;
  }
  const Found found = read(path);
  ASSERT_EQ(found.messages.size(), 10U);
  EXPECT_TRUE(found.notes.empty()) << found.notes.front();
  for (int i = 0; i < 10; ++i) {
    const BagMessage& message = found.messages[static_cast<std::size_t>(i)];
    EXPECT_EQ(message.topic, i % 2 == 0 ? "/left" : "/right");
    EXPECT_EQ(message.type, "std_msgs/String");
    EXPECT_EQ(message.time, (100 + i) * std::int64_t{1'000'000'000});
    EXPECT_NE(message.bytes.find("message " + std::to_string(i) + std::string(300, '.')), std::string::npos);
  }
}

INSTANTIATE_TEST_SUITE_P(Files, RealWriters,
                         testing::Values("ros1_none.bag", "ros1_lz4.bag", "ros1_bz2.bag", "mcap_none.mcap",
                                         "mcap_lz4.mcap", "mcap_zstd.mcap", "mcap_unchunked.mcap",
                                         "ros2.db3"));

TEST(BagFolder, ItsFilesAreOneRecordingInTheOrderOfTheirNumbers) {
  const test::TemporaryDirectory folder;
  const std::vector<BagMessage> all = eight_messages();
  test::write_file(folder / "metadata.yaml", "rosbag2_bagfile_information:\n");
  test::write_file(folder / "run_10.mcap", test::mcap_file({all.begin() + 5, all.end()}, "cdr"));
  test::write_file(folder / "run_9.mcap", test::mcap_file({all.begin(), all.begin() + 5}, "cdr"));
  const Found found = read(folder.path());
  expect_messages(found, 8);
  EXPECT_EQ(found.topics.size(), 2U);
  EXPECT_EQ(found.topics[0].messages, 4U);
  test::write_file(folder / "run_11.mcap.zstd", "");
  expect_error<InputError>([&] { read(folder.path()); }, {"run_11.mcap.zstd", "zstd -d"});
}

TEST(ChunkPacking, TellsWhatDoesNotUnpackToItsSize) {
  EXPECT_EQ(unpack_chunk("abc", Packing::none, 3, "here"), "abc");
  expect_error<InputError>([] { unpack_chunk("abc", Packing::none, 4, "here"); }, {"here", "4 bytes", "3"});
  expect_error<InputError>([] { unpack_chunk("abc", Packing::none, kLargestChunk + 1, "here"); },
                           {"at most"});
  for (const auto& [packing, name] :
       {std::pair(Packing::lz4, "lz4"), {Packing::bz2, "bz2"}, {Packing::zstd, "zstd"}}) {
    if (!has(name)) continue;
    expect_error<InputError>([&, packing = packing] { unpack_chunk("no such bytes", packing, 100, "here"); },
                             {"here"});
    expect_error<InputError>([&, packing = packing] { unpack_chunk("", packing, 100, "here"); },
                             {"100 unpacked bytes", "0"});
  }
}

}  // namespace
}  // namespace penumbra::slam
