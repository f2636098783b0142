#include "slam/frontend/features/frame_matcher.h"

#include <gtest/gtest.h>

#include <limits>

#include "nn/base/counter_random.h"
#include "slam/frontend/features/descriptor_matcher.h"

namespace penumbra::slam {
namespace {

Descriptor random_descriptor(std::uint64_t seed) {
  return {counter_random(seed, 0), counter_random(seed, 1), counter_random(seed, 2), counter_random(seed, 3)};
}

// Features on a grid of 20 pixels, each with a descriptor of its own.
FrameFeatures grid_frame() {
  FrameFeatures frame;
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) {
      frame.left.keypoints.push_back(
          {20.0F * static_cast<float>(x) + 10.0F, 20.0F * static_cast<float>(y) + 10.0F, 0, 0.3F, 1.0F});
      frame.left.descriptors.push_back(random_descriptor(static_cast<std::uint64_t>(20 * y + x)));
    }
  }
  const std::size_t n = frame.left.keypoints.size();
  frame.u_right.assign(n, -1.0F);
  frame.depth.assign(n, -1.0F);
  frame.grid = FeatureGrid(frame.left.keypoints, 400, 200);
  return frame;
}

std::vector<Projection> projections_of(const FrameFeatures& frame, float shift) {
  std::vector<Projection> projections;
  for (int i = 0; i < frame.size(); ++i) {
    const Keypoint& k = frame.keypoint(i);
    projections.push_back({k.u + shift, k.v, -1.0F, 0, k.angle, &frame.descriptor(i), i});
  }
  return projections;
}

const std::vector<double> kScales = {1.0, 1.2, 1.44};

TEST(FrameMatcher, FindsEveryFeatureInItsWindow) {
  const FrameFeatures frame = grid_frame();
  const std::vector<Match> matches = match_projections(projections_of(frame, 6.0F), frame, {}, kScales, {});
  ASSERT_EQ(matches.size(), 200U);
  for (const Match& m : matches) EXPECT_EQ(m.source, m.feature);
}

TEST(FrameMatcher, FindsNothingOutsideItsWindowOrAmongTakenAndMovableFeatures) {
  const FrameFeatures frame = grid_frame();
  FrameMatcherSettings narrow;
  narrow.radius = 5.0F;
  narrow.max_distance = 60;
  EXPECT_TRUE(match_projections(projections_of(frame, 8.0F), frame, {}, kScales, narrow).empty());
  const std::vector<char> taken(200, 1);
  EXPECT_TRUE(match_projections(projections_of(frame, 0.0F), frame, taken, kScales, narrow).empty());
  const std::vector<char> movable(200, 1);
  const FeatureView moving(frame, movable);
  EXPECT_TRUE(match_projections(projections_of(frame, 0.0F), moving, {}, kScales, narrow).empty());
  EXPECT_FALSE(match_projections(projections_of(frame, 0.0F), frame, {}, kScales, narrow).empty());
}

TEST(FrameMatcher, AFeatureKeepsTheNearestOfItsSuitors) {
  const FrameFeatures frame = grid_frame();
  Descriptor similar = frame.descriptor(0);
  similar[0] ^= 0xFF;
  const Keypoint& k = frame.keypoint(0);
  const std::vector<Projection> projections = {{k.u, k.v, -1.0F, 0, k.angle, &similar, 7},
                                               {k.u, k.v, -1.0F, 0, k.angle, &frame.descriptor(0), 8},
                                               {k.u, k.v, -1.0F, 0, k.angle, &similar, 9}};
  const std::vector<Match> matches = match_projections(projections, frame, {}, kScales, {});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].source, 8);
}

TEST(FrameMatcher, RemovesPairsThatTurnAgainstTheRest) {
  const FrameFeatures frame = grid_frame();
  std::vector<Projection> projections = projections_of(frame, 0.0F);
  projections[5].angle += 2.0F;
  projections[50].angle -= 1.5F;
  const std::vector<Match> matches = match_projections(projections, frame, {}, kScales, {});
  EXPECT_EQ(matches.size(), 198U);
}

TEST(FrameMatcher, TakesPositionsThatAreNotNumbers) {
  const FrameFeatures frame = grid_frame();
  std::vector<Projection> projections = projections_of(frame, 0.0F);
  projections.resize(3);
  projections[0].u = std::numeric_limits<float>::quiet_NaN();
  projections[1].v = std::numeric_limits<float>::infinity();
  projections[2].u = -1e30F;
  EXPECT_TRUE(match_projections(projections, frame, {}, kScales, {}).empty());
  EXPECT_TRUE(match_projections({}, frame, {}, kScales, {}).empty());
  FrameFeatures empty;
  empty.grid = FeatureGrid({}, 400, 200);
  EXPECT_TRUE(match_projections(projections_of(frame, 0.0F), empty, {}, kScales, {}).empty());
}

TEST(DescriptorMatcher, FindsAPermutation) {
  std::vector<Descriptor> a, b;
  for (std::uint64_t i = 0; i < 100; ++i) a.push_back(random_descriptor(i));
  for (std::uint64_t i = 0; i < 100; ++i) b.push_back(random_descriptor((i * 37) % 100));
  const std::vector<Match> matches = match_descriptors(a, b, {});
  ASSERT_EQ(matches.size(), 100U);
  for (const Match& m : matches) EXPECT_EQ(m.distance, 0);
  EXPECT_TRUE(match_descriptors(a, {}, {}).empty());
  EXPECT_TRUE(match_descriptors({}, b, {}).empty());
}

TEST(DescriptorMatcher, RefusesAmbiguousPairs) {
  const Descriptor d = random_descriptor(1);
  EXPECT_TRUE(match_descriptors(std::vector<Descriptor>{d}, std::vector<Descriptor>{d, d, d}, {}).size() <=
              1);
  Descriptor near = d;
  near[0] ^= 1;
  Descriptor query = d;
  query[1] ^= 0xFFFF;
  EXPECT_TRUE(
      match_descriptors(std::vector<Descriptor>{query}, std::vector<Descriptor>{d, near}, {}).empty());
}

}  // namespace
}  // namespace penumbra::slam
