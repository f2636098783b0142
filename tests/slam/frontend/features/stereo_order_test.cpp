#include "slam/frontend/features/stereo_order.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "slam/frontend/features/orb_extractor.h"
#include "slam/pipeline/slam.h"
#include "slam/sources/open_dataset.h"
#include "tests/slam/world/synthetic.h"
#include "tests/support/cv_images.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

class StereoOrderCheck : public ::testing::Test {
 protected:
  StereoOrderCheck() {
    camera = {
        .fx = 500.0, .fy = 500.0, .cx = 320.0, .cy = 120.0, .baseline = 0.5, .width = 640, .height = 240};
  }
  // Frame `index` of a wall that is seen with this disparity.
  void check(int index, const cv::Mat& left, const cv::Mat& right) {
    Features left_features, right_features;
    left_orb.extract(test::byte_image(left), left_features);
    right_orb.extract(test::byte_image(right), right_features);
    StereoMatches matches;
    match_stereo(camera, left_features, right_features, left_orb.pyramid(), right_orb.pyramid(), matches);
    order.check(index, camera, left_features, right_features, left_orb.pyramid(), right_orb.pyramid(),
                matches);
  }
  cv::Mat wall(int from) const { return texture(cv::Rect(from, 0, camera.width, camera.height)).clone(); }

  StereoCamera camera;
  OrbExtractor left_orb{OrbSettings{}}, right_orb{OrbSettings{}};
  StereoOrder order;
  cv::Mat texture = test::textured_image(1200, 240, 5);
};

TEST_F(StereoOrderCheck, AGoodPairSettlesIt) {
  check(0, wall(100), wall(125));
  // What comes later may look as it likes.
  for (int i = 1; i < 10; ++i) EXPECT_NO_THROW(check(i, wall(125), wall(100)));
}

TEST_F(StereoOrderCheck, ExchangedImagesAreNamedWithinThreeFrames) {
  check(0, wall(125), wall(100));
  check(1, wall(135), wall(110));
  try {
    check(2, wall(145), wall(120));
    FAIL() << "not noticed";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("left and right exchanged"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("frame 2"), std::string::npos) << error.what();
  }
}

TEST_F(StereoOrderCheck, PairsThatTellNothingAreNoError) {
  const cv::Mat black = cv::Mat::zeros(camera.height, camera.width, CV_8U);
  for (int i = 0; i < 5; ++i) {
    EXPECT_NO_THROW(check(i, black, black));
    // Two different places: no order has matches.
    EXPECT_NO_THROW(check(i, wall(0), test::textured_image(camera.width, camera.height, 77 + i)));
    // Infinitely far away.
    EXPECT_NO_THROW(check(i, wall(100), wall(100)));
  }
}

TEST(StereoOrderRealData, ExchangedKittiImagesAreNoticed) {
  PENUMBRA_REAL_DATA(folder, "kitti/sequences/00");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(folder);
  Slam right_way(dataset->camera(), Sensor::stereo, {}), wrong_way(dataset->camera(), Sensor::stereo, {});
  int frames = 0;
  EXPECT_THROW(
      for (; frames < 5; ++frames) {
        StereoImages images = dataset->load(frames);
        right_way.process(images);
        std::swap(images.left, images.right);
        wrong_way.process(images);
      },
      InputError);
  EXPECT_LT(frames, 5);
}

}  // namespace
}  // namespace penumbra::slam
