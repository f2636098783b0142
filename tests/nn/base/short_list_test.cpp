#include "nn/base/short_list.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace penumbra {
namespace {

TEST(ShortList, HoldsWhatWasAddedAndNoMoreThanItsLength) {
  ShortList<int, 3> list;
  EXPECT_TRUE(list.empty());
  for (int i = 0; i < 3; ++i) list.push_back(10 * i);
  EXPECT_EQ(std::vector<int>(list.begin(), list.end()), (std::vector<int>{0, 10, 20}));
  EXPECT_EQ(list[2], 20);
  EXPECT_THROW(list.push_back(30), std::length_error);
  EXPECT_EQ(list.size(), 3U);
}

}  // namespace
}  // namespace penumbra
