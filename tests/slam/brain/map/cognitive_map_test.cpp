#include "slam/brain/map/cognitive_map.h"

#include <gtest/gtest.h>

namespace penumbra::slam::brain {
namespace {

// 0 - 1 - 2 - 3 - 4 and a link 4 - 1.
CognitiveMap chain() {
  CognitiveMap map;
  for (int i = 0; i < 5; ++i) map.add(Node());
  const int ends[][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 1}};
  for (const auto& [from, to] : ends) {
    Link link;
    link.from = from;
    link.to = to;
    map.add(link);
  }
  return map;
}

TEST(CognitiveMap, CountsTheLinksBetweenNodes) {
  const CognitiveMap map = chain();
  EXPECT_EQ(map.hops(2, 2, 3), 0);
  EXPECT_EQ(map.hops(0, 1, 3), 1);
  EXPECT_EQ(map.hops(0, 4, 3), 2);  // by the link 4 - 1, which counts from both sides
  EXPECT_EQ(map.hops(0, 3, 3), 3);
  EXPECT_EQ(map.hops(0, 3, 2), 3);  // more than 2
}

TEST(CognitiveMap, KnowsTheLinksOfANode) {
  const CognitiveMap map = chain();
  EXPECT_EQ(map.links_of(1), (std::vector<int>{0, 1, 4}));
  EXPECT_EQ(map.links_of(0), (std::vector<int>{0}));
  EXPECT_GT(map.bytes(), 5 * sizeof(Node));
}

}  // namespace
}  // namespace penumbra::slam::brain
