#include "slam/frontend/locating/rim_odometry.h"

#include <gtest/gtest.h>

#include "nn/base/counter_random.h"
#include "tests/slam/feature_world.h"

namespace penumbra::slam {
namespace {

// A stereo pair in which something 1.5 m ahead hides most of the world, and features on it that stand still.
struct CoveredPair {
  FrameFeatures features;
  Features right;
  std::vector<char> movable;
};

class RimOdometry : public ::testing::Test {
 protected:
  static constexpr float kFrom = 100.0F, kTo = 540.0F;  // columns that are hidden in the left image

  CoveredPair pair_at(const SE3& T_cw, std::uint64_t seed) const {
    std::vector<int> seen;
    const auto view = world.view(T_cw, seed, seen);
    const float shift = static_cast<float>(world.camera().fx * world.camera().baseline / 1.5);
    CoveredPair pair;
    const auto add_left = [&](const Keypoint& k, const Descriptor& d, float u_right, bool moves) {
      pair.features.left.keypoints.push_back(k);
      pair.features.left.descriptors.push_back(d);
      pair.features.u_right.push_back(u_right);
      pair.features.depth.push_back(
          u_right < 0.0F ? -1.0F : static_cast<float>(world.camera().depth_from_disparity(k.u - u_right)));
      pair.movable.push_back(moves);
    };
    const auto add_right = [&](Keypoint k, const Descriptor& d, float u_right) {
      k.u = u_right;
      pair.right.keypoints.push_back(k);
      pair.right.descriptors.push_back(d);
    };
    for (int i = 0; i < view->size(); ++i) {
      const Keypoint& k = view->keypoint(i);
      const float u_right = view->u_right[static_cast<std::size_t>(i)];
      const bool in_right = u_right >= 0.0F && (u_right < kFrom - shift || u_right > kTo - shift);
      if (k.u < kFrom || k.u > kTo) add_left(k, view->descriptor(i), in_right ? u_right : -1.0F, false);
      if (in_right) add_right(k, view->descriptor(i), u_right);
    }
    std::uint64_t drawn = 0;  // the same on every image
    for (float v = 4.0F; v < 188.0F; v += 8.0F) {
      for (float u = kFrom + 4.0F; u < kTo; u += 16.0F) {
        Keypoint k;
        k.u = u;
        k.v = v;
        Descriptor d;
        for (std::uint64_t& word : d) word = counter_random(7, drawn++);
        add_left(k, d, u - shift, true);
        if (u > shift) add_right(k, d, u - shift);
      }
    }
    return pair;
  }
  RimView rim_at(const SE3& T_cw, std::uint64_t seed) const {
    const CoveredPair pair = pair_at(T_cw, seed);
    RimView rim;
    collect_rim(FeatureView(pair.features, pair.movable), pair.right, rim);
    return rim;
  }

  const test::FeatureWorld world;
  const RimSettings settings;
};

TEST_F(RimOdometry, LooksBesideWhatCoversTheView) {
  const CoveredPair pair = pair_at(world.T_cw(3.0), 1);
  RimView rim;
  collect_rim(FeatureView(pair.features, pair.movable), pair.right, rim);
  const float shift = static_cast<float>(world.camera().fx * world.camera().baseline / 1.5);
  EXPECT_GT(rim.left.size(), 20);
  EXPECT_GT(rim.right.size(), 20);
  EXPECT_EQ(rim.depth.size(), rim.left.keypoints.size());
  for (const Keypoint& k : rim.left.keypoints) EXPECT_TRUE(k.u < kFrom || k.u > kTo) << k.u;
  for (const Keypoint& k : rim.right.keypoints) EXPECT_GT(k.u, kTo - shift);
}

TEST_F(RimOdometry, TellsATurnThatNothingHasAnnounced) {
  const SE3 before = world.T_cw(3.0);
  for (const double radians : {-0.06, 0.0, 0.06}) {
    const SE3 expected = world.T_cw(4.0) * before.inverse();
    SE3 step = expected;
    step.rotation = so3_exp({0.0, radians, 0.0}) * step.rotation;
    const auto found = rim_step(world.camera(), world.scales(), rim_at(before, 1), rim_at(step * before, 2),
                                {expected, 0.1, 0.02}, settings);
    ASSERT_TRUE(found) << radians;
    EXPECT_LT(so3_log(found->rotation * step.rotation.transpose()).norm(), 0.004) << radians;
    EXPECT_EQ(found->translation, expected.translation);
  }
}

TEST_F(RimOdometry, FindsNothingWhereNothingIsFree) {
  const RimView nothing, rim = rim_at(world.T_cw(3.0), 1);
  const PosePrior standing{SE3{}, 0.1, 0.02};
  EXPECT_FALSE(rim_step(world.camera(), world.scales(), nothing, rim, standing, settings));
  EXPECT_FALSE(rim_step(world.camera(), world.scales(), rim, nothing, standing, settings));
  // Nor where nothing is the same.
  EXPECT_FALSE(
      rim_step(world.camera(), world.scales(), rim, rim_at(world.T_cw(53.0), 2), standing, settings));
}

}  // namespace
}  // namespace penumbra::slam
