#include "slam/map/keyframe_table.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <vector>

namespace penumbra::slam {
namespace {

TEST(KeyframeTable, CountsAsAMapDoes) {
  std::vector<KeyFrame> keyframes(200);
  for (std::size_t i = 0; i < keyframes.size(); ++i) keyframes[i].id = static_cast<int>(3 * i);
  KeyframeTable table;
  std::mt19937 random(1);
  for (int round = 0; round < 50; ++round) {
    table.clear();
    std::map<KeyFrame*, int> oracle;
    for (unsigned n = random() % 500; n > 0; --n) {
      KeyFrame* keyframe = &keyframes[random() % keyframes.size()];
      ++table[keyframe];
      ++oracle[keyframe];
    }
    EXPECT_EQ(table.entries().size(), oracle.size());
    for (KeyFrame& keyframe : keyframes) {
      const int* value = table.find(&keyframe);
      ASSERT_EQ(value != nullptr, oracle.count(&keyframe) > 0);
      if (value != nullptr) {
        EXPECT_EQ(*value, oracle.at(&keyframe));
      }
    }
    table.sort_by_value();
    for (std::size_t i = 0; i < table.entries().size(); ++i) {
      const KeyframeTable::Entry& entry = table.entries()[i];
      EXPECT_EQ(entry.value, oracle.at(entry.keyframe));
      if (i == 0) continue;
      const KeyframeTable::Entry& before = table.entries()[i - 1];
      EXPECT_TRUE(before.value > entry.value ||
                  (before.value == entry.value && before.keyframe->id < entry.keyframe->id));
    }
  }
}

}  // namespace
}  // namespace penumbra::slam
