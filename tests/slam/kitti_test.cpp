#include "slam/datasets/kitti.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

TEST(KittiRealData, Sequence00IsReadFromTheRoot) {
  PENUMBRA_REAL_DATA(root, "kitti");
  DatasetOptions options;
  options.sequence = "00";
  options.frames = parse_frame_range("10:40");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(root, options);
  EXPECT_EQ(dataset->name(), "KITTI odometry 00");
  EXPECT_EQ(dataset->size(), 30);
  EXPECT_EQ(dataset->camera().width, 1241);
  EXPECT_EQ(dataset->camera().height, 376);
  EXPECT_DOUBLE_EQ(dataset->camera().fx, 718.856);
  EXPECT_NEAR(dataset->camera().baseline, 0.53716, 1e-5);
  ASSERT_TRUE(dataset->ground_truth().has_value());
  EXPECT_EQ(dataset->ground_truth()->size(), 30U);
  EXPECT_NEAR(dataset->ground_truth()->front().T_wc.translation.z(), 8.58694, 2.0);
  const StereoImages images = dataset->load(5);
  EXPECT_EQ(images.index, 15);
  EXPECT_EQ(images.timestamp, dataset->timestamp(5));
  EXPECT_EQ(images.right.cols, 1241);
}

TEST(KittiRealData, Sequence06IsReadFromItsOwnFolder) {
  PENUMBRA_REAL_DATA(folder, "kitti/sequences/06/");
  const std::unique_ptr<StereoDataset> dataset = open_dataset(folder);
  EXPECT_EQ(dataset->name(), "KITTI odometry 06");
  EXPECT_EQ(dataset->size(), 51);
  ASSERT_TRUE(dataset->ground_truth().has_value());
}

}  // namespace
}  // namespace penumbra::slam
