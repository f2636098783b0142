#include "slam/sources/row_check.h"

#include <gtest/gtest.h>

#include "tests/slam/world/synthetic.h"
#include "tests/support/cv_images.h"

namespace penumbra::slam {
namespace {

class Rows : public testing::Test {
 protected:
  ByteImage view(int x, int y) const { return ByteImage::copy_of(texture_.region({x, y, 480, 240})); }
  const ByteImage texture_ = test::byte_image(test::textured_image(640, 320, 5));
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
  const ByteImage black = ByteImage::filled(480, 240, 0, 3);
  rows.add(black, black);
  EXPECT_FALSE(rows.is_enough());
  EXPECT_FALSE(rows.disagreement().has_value());
}

}  // namespace
}  // namespace penumbra::slam
