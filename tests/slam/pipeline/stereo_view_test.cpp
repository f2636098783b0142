#include "slam/pipeline/stereo_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "nn/base/quantile.h"
#include "slam/world/street_sequence.h"

namespace penumbra::slam {
namespace {

class StereoView : public testing::Test {
 protected:
  StereoView() {
    synthetic::SequenceSettings settings;
    settings.size = {1240, 376};
    settings.seed = 5;
    settings.colour = true;
    synthetic::StreetSequence street(settings);
    street.render(3, frame_);
    camera_ = street.camera();
    images_.left = frame_.left_bgr;
    images_.right = frame_.right_grey;
  }
  // The median of depth / true depth over the view's pixels nearer than `farthest`.
  double ratio(const DenseView& view, double farthest) const {
    std::vector<double> ratios;
    for (int y = 0; y < view.depth.height(); ++y) {
      for (int x = 0; x < view.depth.width(); ++x) {
        const float z = view.depth_at(x, y), truth = frame_.left.depth.at(4 * x + 2, 4 * y + 2);
        if (z > 0.0F && truth > 0.0F && truth < farthest) ratios.push_back(z / truth);
      }
    }
    EXPECT_GT(ratios.size(), 3000U);
    return quantile_of(ratios, 0.5);
  }

  synthetic::SequenceFrame frame_;
  StereoCamera camera_;
  StereoImages images_;
};

TEST_F(StereoView, HasTheStreetsDepthAndColours) {
  StereoViewMaker maker({}, 16.0);
  const DenseView view = maker.make(camera_, images_);
  EXPECT_EQ(view.depth.size(), (Size{310, 94}));
  EXPECT_EQ(view.colour.channels(), 3);
  EXPECT_NEAR(view.camera.fx, camera_.fx / 4.0, 1e-9);
  EXPECT_NEAR(view.camera.cx, (camera_.cx + 0.5) / 4.0 - 0.5, 1e-9);
  EXPECT_NEAR(ratio(view, 16.0), 1.0, 0.02);
  // Another pair of the same camera with the same maker.
  const DenseView again = maker.make(camera_, images_);
  EXPECT_TRUE(std::equal(view.depth.data(), view.depth.data() + view.depth.elements(), again.depth.data()));
}

TEST_F(StereoView, ItsOffsetIsCorrectedAfterwards) {
  // As if the calibration were wrong by 2 pixels: known at once, or found when the map was made.
  StereoCamera known = camera_;
  known.disparity_offset = 2.0;
  StereoViewMaker maker({}, 16.0);
  DenseView late = maker.make(camera_, images_);
  const DenseView at_once = maker.make(known, images_);
  EXPECT_GT(ratio(at_once, 16.0), 1.04);  // there is no such error in truth
  correct_disparity_offset(late, 0.5);    // of the small image
  EXPECT_EQ(late.camera.disparity_offset, 0.5);
  for (int y = 0; y < late.depth.height(); ++y) {
    for (int x = 0; x < late.depth.width(); ++x) {
      if (late.depth.at(x, y) == 0 || at_once.depth.at(x, y) == 0 || at_once.depth_at(x, y) > 18.0F) continue;
      ASSERT_NEAR(late.depth_at(x, y), at_once.depth_at(x, y), 0.002) << x << ' ' << y;
    }
  }
}

TEST(DenseSettings, FollowFromTheCamera) {
  StereoCamera kitti{.fx = 718.856, .fy = 718.856, .baseline = 0.537, .width = 1241, .height = 376};
  StereoCamera euroc{.fx = 435.0, .fy = 435.0, .baseline = 0.11, .width = 752, .height = 480};
  const DenseSettings wide = with_derived(DenseSettings(), Sensor::stereo, kitti);
  EXPECT_NEAR(wide.plan.cell, 0.2, 1e-12);
  EXPECT_NEAR(wide.fusion.voxel, 0.1, 1e-12);
  EXPECT_NEAR(wide.plan.lowest, 0.3, 1e-12);
  EXPECT_NEAR(wide.fusion.depth_noise * wide.fusion.farthest * wide.fusion.farthest, 0.4, 1e-9);
  EXPECT_NEAR(with_derived(DenseSettings(), Sensor::stereo, euroc).plan.cell, 0.05, 1e-12);
  EXPECT_EQ(wide.stereo.shrink, 4);
  EXPECT_EQ(with_derived(DenseSettings(), Sensor::stereo, euroc).stereo.shrink, 4);
  // The same camera with images of half the size: as many pixels are matched, and depth counts as far.
  StereoCamera half = kitti;
  half.fx = half.fy = 0.5 * kitti.fx;
  half.width = 620;
  half.height = 188;
  const DenseSettings small = with_derived(DenseSettings(), Sensor::stereo, half);
  EXPECT_EQ(small.stereo.shrink, 2);
  EXPECT_EQ(small.plan.cell, wide.plan.cell);
  EXPECT_NEAR(small.fusion.farthest, wide.fusion.farthest, 1e-9);
  // And where they must be matched at a fourth, cells are what depth then tells apart.
  DenseSettings coarse;
  coarse.stereo.shrink = 4;
  EXPECT_NEAR(with_derived(coarse, Sensor::stereo, half).plan.cell, 0.5, 1e-12);
  EXPECT_GT(with_derived(coarse, Sensor::stereo, half).fusion.farthest, wide.fusion.farthest);
  const DenseSettings rgbd = with_derived(DenseSettings(), Sensor::rgbd, euroc);
  EXPECT_EQ(rgbd.plan.cell, 0.05);
  EXPECT_EQ(rgbd.fusion.voxel, 0.01);
  EXPECT_EQ(rgbd.fusion.farthest, 5.0);
  // What is given stays, and the rest follows from it.
  DenseSettings given;
  given.plan.cell = 0.5;
  EXPECT_EQ(with_derived(given, Sensor::stereo, kitti).fusion.voxel, 0.25);
  given.fusion.voxel = 0.125;
  EXPECT_EQ(with_derived(given, Sensor::stereo, kitti).fusion.voxel, 0.125);
}

}  // namespace
}  // namespace penumbra::slam
