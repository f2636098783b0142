// Weights that no network may compute with are refused by name, in every network.
#include "nn/models/weight_reader.h"

#include <gtest/gtest.h>

#include <limits>

#include "nn/base/error.h"
#include "nn/models/classifier.h"
#include "nn/models/mask_rcnn.h"
#include "nn/models/yolov5.h"
#include "tests/support/expect_error.h"
#include "tests/support/random_models.h"
#include "tests/support/random_network.h"

namespace penumbra::nn {
namespace {

using test::expect_error;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Replaces one element of a tensor.
void set_element(StateDict& weights, const std::string& name, std::size_t index, float value) {
  StoredTensor& tensor = weights.tensors.at(name);
  const auto values = std::make_shared<std::vector<float>>(tensor.to_f32());
  values->at(index) = value;
  tensor.type = DataType::f32;
  tensor.bytes = std::as_bytes(std::span(*values));
  weights.owners.push_back(values);
}

TEST(WeightReader, NanAndInfiniteWeightsOfEveryNetworkAreRefusedByName) {
  StateDict mask_rcnn = test::random_mask_rcnn(false);
  set_element(mask_rcnn, "roi_heads.mask_head.0.0.weight", 5, kNan);
  set_element(mask_rcnn, "rpn.head.cls_logits.bias", 1, kInfinity);
  expect_error<InputError>([&] { MaskRcnn{mask_rcnn}; },
                           {"2 that do not fit", "roi_heads.mask_head.0.0.weight", "nan at index 5, 1 of",
                            "rpn.head.cls_logits.bias", "inf at index 1, 1 of 3"});
  StateDict yolov5 = test::random_yolov5({.folded = true});
  set_element(yolov5, "model.24.m.1.bias", 0, -kInfinity);
  expect_error<InputError>([&] { Yolov5{yolov5}; }, {"model.24.m.1.bias", "-inf at index 0"});
  StateDict resnet = test::random_resnet(18, 16);
  set_element(resnet, "fc.weight", 2, kNan);
  expect_error<InputError>([&] { Classifier{resnet}; }, {"fc.weight", "nan at index 2"});
}

TEST(WeightReader, AVarianceThatCannotBeDividedByIsRefusedByName) {
  const std::string norm = "backbone.body.layer1.0.bn1.running_var";
  StateDict weights = test::random_mask_rcnn(false);
  set_element(weights, norm, 3, 0.0F);
  EXPECT_NO_THROW(MaskRcnn{weights});
  weights.metadata["batch_norm_eps"] = "0";
  expect_error<InputError>([&] { MaskRcnn{weights}; }, {norm, "0 + 0 in channel 3", "16 bits"});
  set_element(weights, norm, 3, -1.0F);
  expect_error<InputError>([&] { MaskRcnn{weights}; }, {norm, "-1 + 0 in channel 3"});
}

TEST(WeightReader, WeightsThatFoldingMakesInfiniteAreRefusedByName) {
  StateDict weights = test::random_mask_rcnn(false);
  weights.metadata["batch_norm_eps"] = "0";
  set_element(weights, "backbone.body.layer1.0.bn1.running_var", 3, 1e-38F);
  set_element(weights, "backbone.body.layer1.0.bn1.weight", 3, 1e30F);
  expect_error<InputError>([&] { MaskRcnn{weights}; },
                           {"backbone.body.layer1.0.conv1.weight", "backbone.body.layer1.0.bn1 folded"});
}

TEST(WeightReader, TheClassifierTakesItsEpsilonFromTheMetadata) {
  StateDict weights = test::random_resnet(18, 16);
  set_element(weights, "bn1.running_var", 0, 0.0F);
  EXPECT_NO_THROW(Classifier{weights});
  weights.metadata["batch_norm_eps"] = "0";
  expect_error<InputError>([&] { Classifier{weights}; }, {"bn1.running_var"});
}

}  // namespace
}  // namespace penumbra::nn
