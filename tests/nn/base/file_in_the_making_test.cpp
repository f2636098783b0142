#include "nn/base/file_in_the_making.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <iterator>
#include <string>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::nn {
namespace {

namespace fs = std::filesystem;

class FileInTheMakingTest : public ::testing::Test {
 protected:
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder.path()), {}));
  }
  test::TemporaryDirectory folder;
};

TEST_F(FileInTheMakingTest, IsThereWholeOrNotAtAll) {
  write_file(folder / "a", "old");
  {
    FileInTheMaking file(folder / "a");
    file.write("new", 3);
    EXPECT_EQ(read_file(folder / "a", "a file"), "old");
  }
  EXPECT_EQ(read_file(folder / "a", "a file"), "old");
  EXPECT_EQ(files(), 1U) << "nothing is left of what was not committed";
  FileInTheMaking file(folder / "a");
  file.write("new", 3);
  file.commit();
  EXPECT_EQ(read_file(folder / "a", "a file"), "new");
  EXPECT_EQ(files(), 1U);
}

TEST_F(FileInTheMakingTest, FollowsLinks) {
  fs::create_directory(folder / "disk");
  fs::create_symlink("disk/real", folder / "relative");  // leads to nothing yet
  fs::create_symlink(folder / "relative", folder / "link");
  for (const char* text : {"first", "second"}) {
    write_file(folder / "link", text);
    EXPECT_EQ(read_file(folder / "disk/real", "a file"), text);
    EXPECT_TRUE(fs::is_symlink(folder / "link") && fs::is_symlink(folder / "relative"));
  }
}

// As /dev/null, which root could otherwise replace for the whole machine.
TEST_F(FileInTheMakingTest, WritesToWhatIsNoPlainFile) {
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  write_file(pipe, "text");
  char text[8] = {};
  EXPECT_EQ(read(reader, text, sizeof text), 4);
  EXPECT_STREQ(text, "text");
  close(reader);
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(files(), 1U);
}

// Of three times what is gathered in memory: it is there from commit() on, and not at all without.
TEST_F(FileInTheMakingTest, TextComesPieceByPiece) {
  std::string expected;
  for (const bool committed : {false, true}) {
    TextInTheMaking text(folder / "text");
    for (int i = 0; i < 30000; ++i) {
      const std::string line = std::to_string(i) + "\n";
      if (committed) expected += line;
      if (i % 2 == 0) {
        text.add(line);
      } else {
        text.text() += line;
        text.flush_if_long();
      }
    }
    EXPECT_FALSE(fs::exists(folder / "text"));
    if (committed) text.commit();
  }
  EXPECT_EQ(read_file(folder / "text", "the text"), expected);
  EXPECT_EQ(files(), 1U);
}

TEST_F(FileInTheMakingTest, SaysWhatCannotBeWritten) {
  test::expect_error<Error>([&] { write_file(folder.path(), "text"); }, {"cannot be written", "a folder"});
  test::expect_error<Error>([&] { write_file(folder / "no/such", "text"); }, {"no/such: cannot be written"});
  test::expect_error<Error>([&] { require_writable_folder(folder / "no"); },
                            {"no/.penumbra: cannot be written"});
  require_writable_folder(folder.path());
  EXPECT_EQ(files(), 0U);
}

}  // namespace
}  // namespace penumbra::nn
