#include "nn/base/counted.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

TEST(Counted, OneIsSingular) {
  EXPECT_EQ(counted(0, "map"), "0 maps");
  EXPECT_EQ(counted(1, "map"), "1 map");
  EXPECT_EQ(counted(2, "map"), "2 maps");
  EXPECT_EQ(counted(std::size_t{1}, "map"), "1 map");
  EXPECT_EQ(counted(std::int64_t{7'000'000'000}, "byte"), "7000000000 bytes");
  EXPECT_EQ(counted(1, "chunk or record", "chunks or records"), "1 chunk or record");
  EXPECT_EQ(counted(3, "chunk or record", "chunks or records"), "3 chunks or records");
}

}  // namespace
}  // namespace penumbra
