#include "nn/base/number_file.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::nn {
namespace {

using test::expect_error;

TEST(NumberFile, ReadsRecordsAndSkipsCommentsAndEmptyLines) {
  const test::TemporaryDirectory folder;
  write_file(folder / "a.txt", "# two columns\n1 +2\r\n\n \t-3.5e-1\t4E2 \n5 1e-400");
  const std::vector<NumberLine> lines = read_number_file(folder / "a.txt", 2, "two numbers");
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_EQ(lines[0].values, (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(lines[1].values, (std::vector<double>{-0.35, 400.0}));
  EXPECT_EQ(lines[1].line, 4);
  EXPECT_EQ(lines[2].values, (std::vector<double>{5.0, 0.0}));
}

TEST(NumberFile, WhatIsNotAFiniteNumberIsRefusedWithItsLine) {
  const test::TemporaryDirectory folder;
  for (const std::string word : {"nan", "-nan", "NaN", "inf", "-inf", "1e999"}) {
    write_file(folder / "a.txt", "1\n2\n" + word + "\n");
    expect_error<InputError>([&] { read_number_file(folder / "a.txt", 1, "a number"); },
                             {(folder / "a.txt").string() + ":3", "finite", "'" + word + "'"});
  }
  for (const std::string word : {"x", "1.2.3", "1,5", "0x10", "+-3", "--3", "+", "1e"}) {
    write_file(folder / "a.txt", "1\n" + word + "\n");
    expect_error<InputError>([&] { read_number_file(folder / "a.txt", 1, "a number"); },
                             {"a.txt:2", "expected a number", "'" + word + "'"});
  }
}

TEST(NumberFile, AWrongNumberOfColumnsIsRefusedWithItsLine) {
  const test::TemporaryDirectory folder;
  write_file(folder / "a.txt", "1 2 3\n1 2\n");
  expect_error<InputError>([&] { read_number_file(folder / "a.txt", 3, "a point"); },
                           {"a.txt:2", "a point (3 numbers)", "found 2 numbers"});
}

TEST(NumberFile, BinaryDataIsRefusedWithAShortMessage) {
  const test::TemporaryDirectory folder;
  write_file(folder / "a.txt", std::string(100000, 'x'));
  try {
    read_number_file(folder / "a.txt", 1, "a number");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_LT(std::string(error.what()).size(), 300U);
  }
}

TEST(WriteFile, ReplacesTheOldFileAndLeavesNothingElse) {
  const test::TemporaryDirectory folder;
  write_file(folder / "a.txt", "old and long");
  write_file(folder / "a.txt", "new");
  EXPECT_EQ(read_file(folder / "a.txt", "text"), "new");
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    files += entry.exists() ? 1 : 0;
  EXPECT_EQ(files, 1);
  std::filesystem::create_directory(folder / "b");
  expect_error<Error>([&] { write_file(folder / "b", "text"); }, {"/b: cannot be written"});
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}

}  // namespace
}  // namespace penumbra::nn
