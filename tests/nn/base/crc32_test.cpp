#include "nn/base/crc32.h"

#include <gtest/gtest.h>

namespace penumbra::nn {
namespace {

TEST(Crc32, AgreesWithTheCheckValueOfTheStandard) { EXPECT_EQ(crc32("123456789"), 0xCBF43926U); }

TEST(Crc32, CanBeContinued) {
  EXPECT_EQ(crc32("6789", crc32("12345")), crc32("123456789"));
  EXPECT_EQ(crc32(""), 0U);
}

}  // namespace
}  // namespace penumbra::nn
