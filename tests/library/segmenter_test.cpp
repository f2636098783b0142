#include "penumbra/segmenter.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "penumbra/evaluation.h"
#include "penumbra/image_file.h"
#include "penumbra/version.h"

namespace penumbra {
namespace {

const std::string kSource = PENUMBRA_SOURCE_DIR;

TEST(LibrarySegmenter, FindsThings) {
  Segmenter segmenter(kSource + "/weights_tools/models/penumbra-tiny.safetensors", {.least_score = 0.05F});
  EXPECT_TRUE(segmenter.has_masks());
  EXPECT_NE(segmenter.network().find("Mask R-CNN"), std::string::npos);
  const ImageFile image = read_image(kSource + "/docs/images/street-presets.jpg", /*colour=*/true);
  const std::vector<Instance> found = segmenter.find(image.view());
  ASSERT_FALSE(found.empty());
  float last = 1.0F;
  for (const Instance& thing : found) {
    EXPECT_LE(thing.score, last);
    EXPECT_GE(thing.score, 0.05F);
    last = thing.score;
    EXPECT_FALSE(thing.class_name.empty());
    EXPECT_EQ(thing.mask.size(),
              static_cast<std::size_t>(thing.mask_width) * static_cast<std::size_t>(thing.mask_height));
    EXPECT_LE(thing.mask_x + thing.mask_width, image.width);
  }
  EXPECT_THROW(segmenter.find({}), std::runtime_error);
  EXPECT_THROW(Segmenter("/nowhere/weights"), std::runtime_error);
  EXPECT_THROW(read_image("/nowhere/image.png"), std::runtime_error);
}

TEST(LibraryEvaluation, IsZeroForTheSamePathMovedRigidly) {
  std::vector<TimedPose> truth, moved;
  const Pose turn{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {1, 2, 3}};
  for (int i = 0; i < 10; ++i) {
    TimedPose pose{0.1 * i, {}};
    pose.T_world_camera.translation = {1.0 * i, 0.1 * i * i, 0.0};
    truth.push_back(pose);
    pose.T_world_camera = turn * pose.T_world_camera;
    moved.push_back(pose);
  }
  EXPECT_NEAR(evaluate(truth, moved).rmse, 0.0, 1e-9);
  EXPECT_EQ(evaluate(truth, moved).poses, 10);
  moved[3].T_world_camera.translation[2] += 1.0;
  EXPECT_NEAR(evaluate(truth, moved).max, 0.9, 0.1);
  EXPECT_THROW(evaluate({}, moved), std::runtime_error);
}

TEST(LibraryVersion, IsThatOfTheBuild) { EXPECT_STREQ(version(), PENUMBRA_VERSION); }

}  // namespace
}  // namespace penumbra
