#include "slam/brain/templates/template_memory.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"

namespace penumbra::slam::brain {
namespace {

Template profile_of(float value, int column) {
  Template view;
  for (int y = 0; y < kProfileHeight; ++y)
    view.profile[static_cast<std::size_t>(y * kProfileWidth + column)] = value;
  return view;
}

Template sign(std::size_t direction) {
  Template view;
  Landmark landmark;
  landmark.landmark_class = kSign;
  landmark.interest = 0.5F;
  landmark.descriptor[direction] = 1.0F;
  view.landmarks.push_back(landmark);
  return view;
}

TEST(TemplateMemory, RanksProfilesByTheirLikeness) {
  TemplateMemory memory(TemplateKind::intensity, {}, {});
  EXPECT_EQ(memory.add(profile_of(9.0F, 10)), 0);
  EXPECT_EQ(memory.add(profile_of(9.0F, 40)), 1);
  EXPECT_EQ(memory.add(profile_of(9.0F, 38)), 2);
  std::vector<TemplateMatch> matches;
  memory.query(profile_of(9.0F, 40), 3, matches);
  ASSERT_EQ(matches.size(), 3U);
  // 1 is the view, 2 is the view shifted; of equals the smaller number comes first. 0 differs in two columns
  // of the 60: 1 - 2 x 9 / 60.
  EXPECT_EQ(matches[0].number, 1);
  EXPECT_EQ(matches[1].number, 2);
  EXPECT_EQ(matches[1].similarity, 1.0);
  EXPECT_NEAR(matches[2].similarity, 0.7, 0.03);
  memory.query(profile_of(9.0F, 40), 1, matches);
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].number, 0);
  // What the template shows in column 38 is in column 40 now: two fields of 60.
  EXPECT_NEAR(memory.turn_against(2, profile_of(9.0F, 40), 1.2), 2.0 / 60.0 * 1.2, 1e-9);
}

TEST(TemplateMemory, RanksLandmarksByTheirLikeness) {
  TemplateMemory memory(TemplateKind::landmarks, {}, {});
  for (const std::size_t direction : {3U, 7U, 12U}) memory.add(sign(direction));
  std::vector<TemplateMatch> matches;
  memory.query(sign(7), 3, matches);
  ASSERT_FALSE(matches.empty());
  EXPECT_EQ(matches[0].number, 1);
  EXPECT_NEAR(matches[0].similarity, 1.0, 1e-6);
  EXPECT_NEAR(memory.likeness(2, sign(7)), 0.0, 1e-6);
  EXPECT_EQ(memory.at(2).landmarks.front().descriptor[12], 1.0F);
  EXPECT_GT(memory.bytes(), 3 * sizeof(Landmark));
}

TEST(TemplateMemory, KindsHaveNames) {
  for (const TemplateKind kind : {TemplateKind::landmarks, TemplateKind::intensity})
    EXPECT_EQ(template_kind(to_string(kind)), kind);
  EXPECT_THROW(template_kind("colour"), UsageError);
}

}  // namespace
}  // namespace penumbra::slam::brain
