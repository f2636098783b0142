#include "nn/base/ceil_div.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

TEST(CeilDiv, RoundsUp) {
  EXPECT_EQ(ceil_div(0, 8), 0);
  EXPECT_EQ(ceil_div(1, 8), 1);
  EXPECT_EQ(ceil_div(8, 8), 1);
  EXPECT_EQ(ceil_div(9, 8), 2);
  static_assert(ceil_div(17, 16) == 2);
}

}  // namespace
}  // namespace penumbra
