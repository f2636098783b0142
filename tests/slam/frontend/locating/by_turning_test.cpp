#include "slam/frontend/locating/by_turning.h"

#include "slam/frontend/locating/last_frame_search.h"
#include "tests/slam/frontend/locating/locating_scene.h"

namespace penumbra::slam {
namespace {

class ByTurning : public test::LocatingScene {
 protected:
  // Something covers half of the view, and the camera has turned to the left of where it was expected.
  Frame turned(double radians) {
    Vector6d turn = Vector6d::Zero();
    turn[4] = radians;
    truth = SE3::exp(turn) * predicted;
    Frame frame = frame_at(truth);
    frame.covered_share = 0.5;
    for (std::size_t i = 0; i < frame.movable.size(); ++i) {
      const float u = frame.features->keypoint(static_cast<int>(i)).u;
      frame.movable[i] = u > 0.25F * 620.0F && u < 0.75F * 620.0F;
    }
    return frame;
  }
  LocatingInput covered_input(const Frame& frame) {
    LocatingInput in = input(frame, predicted);
    in.prior = PosePrior{predicted, settings.motion_change_metres, settings.motion_change_radians};
    return in;
  }

  const SE3 predicted = world.T_cw(10.5);
  SE3 truth;
};

TEST_F(ByTurning, FindsABendThatNothingHasAnnounced) {
  for (const double radians : {-0.15, 0.15}) {
    const Frame frame = turned(radians);
    const LocatingInput in = covered_input(frame);
    locate_by_turning(in, predicted, found, spare);
    ASSERT_TRUE(found.success) << radians;
    EXPECT_LT(error(found, truth), 0.15) << radians;
    EXPECT_LT((found.T_cw * truth.inverse()).angle(), 0.01) << radians;
    search_last_frame(in, predicted, settings.search_radius, in.prior, spare);
    EXPECT_GT(found.pairs(), 2 * spare.pairs()) << "straight ahead";
  }
}

TEST_F(ByTurning, LooksNoFartherThanATurnCanTake) {
  const Frame frame = turned(0.6);
  locate_by_turning(covered_input(frame), predicted, found, spare);
  EXPECT_FALSE(found.success);
}

TEST_F(ByTurning, FindsNothingWhereNothingIsSeen) {
  Frame frame = turned(0.1);
  std::fill(frame.movable.begin(), frame.movable.end(), 1);
  locate_by_turning(covered_input(frame), predicted, found, spare);
  EXPECT_FALSE(found.success);
  EXPECT_EQ(found.inliers, 0);
}

}  // namespace
}  // namespace penumbra::slam
