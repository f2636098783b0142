#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/natural_order.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::nn {
namespace {

using namespace std::string_view_literals;

class TextFile : public testing::Test {
 protected:
  std::string read(std::string_view bytes) const {
    write_file(path(), bytes);
    return read_text_file(path(), "a list");
  }
  std::filesystem::path path() const { return folder_ / "list.txt"; }
  test::TemporaryDirectory folder_;
};

TEST_F(TextFile, MarksAndLineEndsOfAllSystemsAreTaken) {
  EXPECT_EQ(read("\xEF\xBB\xBF"
                 "1\n2\n"),
            "1\n2\n");
  EXPECT_EQ(read("1\r\n2\r\n"), "1\n2\n");
  EXPECT_EQ(read("1\r2\r"), "1\n2\n");
  EXPECT_EQ(read("1\n\r\n2"), "1\n\n2");
  EXPECT_EQ(read(""), "");
  EXPECT_EQ(read("\xEF\xBB\xBF"), "");
  EXPECT_EQ(read("\xEF\xBB"), "\xEF\xBB");
}

TEST_F(TextFile, OtherEncodingsAreNamed) {
  for (const std::string_view bytes : {"\xFF\xFE"
                                       "1\0"sv,
                                       "\xFE\xFF\0"
                                       "1"sv,
                                       "1\0\n\0"sv,
                                       "\0"
                                       "1\0\n"sv})
    test::expect_error<InputError>([&] { read(bytes); }, {"list.txt", "UTF-8", "UTF-16", "iconv"});
  test::expect_error<InputError>(
      [&] {
        read(
            "\xFF\xFE\0\0"
            "1\0\0\0"sv);
      },
      {"list.txt", "UTF-32"});
}

TEST(NaturalOrder, DigitsCompareAsNumbers) {
  const std::string_view sorted[] = {"",
                                     "0",
                                     "1",
                                     "2",
                                     "10",
                                     "a",
                                     "a1b",
                                     "a01c",
                                     "a2",
                                     "a10",
                                     "a10b",
                                     "b",
                                     "b9999999999999999999999998",
                                     "b9999999999999999999999999",
                                     "b10000000000000000000000000"};
  for (std::size_t i = 0; i < std::size(sorted); ++i) {
    for (std::size_t j = 0; j < std::size(sorted); ++j)
      EXPECT_EQ(natural_less(sorted[i], sorted[j]), i < j) << sorted[i] << " " << sorted[j];
  }
  EXPECT_TRUE(natural_less("007", "7"));
  EXPECT_FALSE(natural_less("7", "007"));
}

}  // namespace
}  // namespace penumbra::nn
