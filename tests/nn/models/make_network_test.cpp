#include "nn/models/make_network.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "tests/support/expect_error.h"
#include "tests/support/random_models.h"
#include "tests/support/random_network.h"

namespace penumbra::nn {
namespace {

TEST(MakeNetwork, TellsTheNetworkByNamesOrMetadata) {
  EXPECT_EQ(make_network(test::random_mask_rcnn(false))->name(), "Mask R-CNN ResNet-50 FPN");
  StateDict yolov5 = test::random_yolov5({0.125, 1.0 / 3.0, 2, false, true});
  EXPECT_EQ(make_network(yolov5)->name(), "YOLOv5 (width 0.125, depth 0.333)");
  EXPECT_FALSE(make_network(yolov5)->has_masks());
  EXPECT_EQ(make_network(yolov5)->classes(), 3);
  yolov5.metadata["network"] = "yolov5";
  EXPECT_NO_THROW(make_network(yolov5));
  yolov5.metadata["network"] = "mask_rcnn";
  EXPECT_THROW(make_network(yolov5), InputError);
  yolov5.metadata["network"] = "perceptron";
  test::expect_error<InputError>([&] { make_network(yolov5); }, {"metadata network", "'perceptron'"});
  test::expect_error<InputError>([&] { make_network(test::random_interest()); },
                                 {"metadata network", "'interest'"});
}

}  // namespace
}  // namespace penumbra::nn
