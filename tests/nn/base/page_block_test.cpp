#include "nn/base/page_block.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

namespace penumbra {
namespace {

TEST(PageBlock, IsAlignedAndZero) {
  const PageBlock block(std::size_t{5} << 20);
  ASSERT_FALSE(block.empty());
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block.data()) % (std::size_t{2} << 20), 0U);
  EXPECT_TRUE(std::all_of(block.data(), block.data() + block.bytes(),
                          [](std::byte value) { return value == std::byte{0}; }));
}

TEST(PageBlock, KeepsWhatIsNotCut) {
  PageBlock block(std::size_t{9} << 20);
  std::fill_n(block.data(), block.bytes(), std::byte{7});
  block.cut(std::size_t{20} << 20);
  EXPECT_EQ(block.bytes(), std::size_t{9} << 20);
  for (const std::size_t bytes : {(std::size_t{3} << 20) + 1, std::size_t{70}, std::size_t{1}}) {
    block.cut(bytes);
    ASSERT_EQ(block.bytes(), bytes);
    EXPECT_EQ(block.data()[bytes - 1], std::byte{7});
  }
}

TEST(PageBlock, MovesWithItsMemory) {
  PageBlock block(100), other;
  EXPECT_TRUE(other.empty());
  block.data()[99] = std::byte{1};
  other = std::move(block);
  EXPECT_EQ(other.data()[99], std::byte{1});
  other = PageBlock();
  EXPECT_TRUE(other.empty());
  EXPECT_TRUE(PageBlock(0).empty());
}

TEST(PageBlock, MayBeFarLargerThanTheMachineAndIsEmptyWhereThereIsNoRoom) {
  PageBlock block(std::size_t{1} << 40);  // a TB; some systems refuse it
  if (!block.empty()) block.data()[std::size_t{1} << 39] = std::byte{1};
  EXPECT_TRUE(PageBlock(std::size_t{1} << 60).empty());
}

}  // namespace
}  // namespace penumbra
