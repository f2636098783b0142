#include "slam/sources/row_check.h"

#include <gtest/gtest.h>

#include "tests/slam/world/synthetic.h"

namespace penumbra::slam {
namespace {

class Rows : public testing::Test {
 protected:
  cv::Mat view(int x, int y) const { return texture_(cv::Rect(x, y, 480, 240)).clone(); }
  cv::Mat texture_ = test::textured_image(640, 320, 5);
};

TEST_F(Rows, OfARectifiedPairAgree) {
  RowOffsets rows;
  rows.add(view(40, 20), view(60, 20));
  EXPECT_TRUE(rows.is_enough());
  EXPECT_FALSE(rows.disagreement().has_value());
}

TEST_F(Rows, ThatAreShiftedAreMeasured) {
  RowOffsets rows;
  rows.add(view(40, 20), view(60, 13));
  ASSERT_TRUE(rows.disagreement().has_value());
  EXPECT_NEAR(rows.disagreement()->median, 7.0, 0.5);
  EXPECT_NEAR(rows.disagreement()->median_length, 7.0, 0.5);
}

TEST_F(Rows, OfImagesWithoutFeaturesTellNothing) {
  RowOffsets rows;
  rows.add(cv::Mat::zeros(240, 480, CV_8UC3), cv::Mat::zeros(240, 480, CV_8UC3));
  EXPECT_FALSE(rows.is_enough());
  EXPECT_FALSE(rows.disagreement().has_value());
}

}  // namespace
}  // namespace penumbra::slam
