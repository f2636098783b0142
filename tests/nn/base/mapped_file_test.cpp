#include "nn/base/mapped_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "nn/base/error.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"

namespace penumbra {
namespace {

TEST(MappedFile, ShowsTheBytesEvenAfterTheFileIsGone) {
  const test::TemporaryDirectory folder;
  test::write_file(folder / "file", "penumbra");
  const auto file = MappedFile::open(folder / "file");
  std::filesystem::remove(folder / "file");
  ASSERT_EQ(file->bytes().size(), 8U);
  EXPECT_EQ(static_cast<char>(file->bytes()[7]), 'a');
}

TEST(MappedFile, WhatWasForgottenCanBeReadAgain) {
  const test::TemporaryDirectory folder;
  std::string text(100'000, 'a');
  text.back() = 'z';
  test::write_file(folder / "file", text);
  const auto file = MappedFile::open(folder / "file");
  const std::string elsewhere(10'000, 'b');
  for (const std::span<const std::byte> part :
       {file->bytes(), file->bytes().subspan(1, 50'000), file->bytes().last(1), file->bytes().first(0),
        std::as_bytes(std::span(elsewhere))}) {
    file->forget(part);
    EXPECT_EQ(static_cast<char>(file->bytes()[0]), 'a');
    EXPECT_EQ(static_cast<char>(file->bytes()[99'999]), 'z');
  }
  EXPECT_EQ(elsewhere, std::string(10'000, 'b'));
}

TEST(MappedFile, AnEmptyFileHasNoBytes) {
  const test::TemporaryDirectory folder;
  test::write_file(folder / "file", "");
  EXPECT_TRUE(MappedFile::open(folder / "file")->bytes().empty());
}

TEST(MappedFile, WhatIsNoRegularFileIsRefusedAtOnce) {
  const test::TemporaryDirectory folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(MappedFile::open(folder / "pipe"), InputError);
  EXPECT_CONTAINS(test::message_of<InputError>([&] { MappedFile::open(folder.path()); }), "a folder");
  EXPECT_CONTAINS(test::message_of<InputError>([&] { MappedFile::open(folder / "none"); }), "No such file");
}

}  // namespace
}  // namespace penumbra
