// ResNets of all depths as classifiers, against torchvision: see
// weights_tools/reference/make_classifier_fixtures.py.
#include "nn/models/classifier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/image/image_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/product_quantised.h"
#include "tests/support/random_models.h"
#include "tests/support/random_network.h"
#include "tests/support/test_data.h"
#include "weights_tools/load_weights.h"

namespace penumbra::nn {
namespace {

ClassifierConfig small_classifier() {
  ClassifierConfig config;
  config.transform.resize = 72;
  config.transform.crop = 64;
  return config;
}

TEST(Classifier, EveryDepthAndWidthGivesTorchvisionsLogits) {
  for (const nlohmann::json& expected : test::read_json(test::fixture("classifier/random_resnets.json"))) {
    const Classifier network(test::random_resnet(expected["depth"], expected["width"]), small_classifier());
    SCOPED_TRACE(network.name());
    EXPECT_EQ(network.name(), fmt::format("ResNet-{}", expected["depth"].get<int>()));
    Arena arena;
    const ByteImage image = test::random_image(expected["seed"], expected["image"][0], expected["image"][1]);
    const std::vector<float> logits = network(image, arena);
    const std::vector<float> wanted = expected["logits"];
    ASSERT_EQ(logits.size(), wanted.size());
    float largest = 0.0F;
    for (const float logit : wanted) largest = std::max(largest, std::abs(logit));
    for (std::size_t c = 0; c < wanted.size(); ++c) EXPECT_NEAR(logits[c], wanted[c], 1e-4F * largest);
    EXPECT_EQ(network(image, arena), logits);
    EXPECT_EQ(arena.recordings(), 1U) << "the second image replays the plan of the first";
  }
}

TEST(Classifier, ImageNetPhotographsGetPyTorchsClassesAndLogits) {
  PENUMBRA_REAL_DATA(weights, "weights/resnet50_imagenet_pqf.pth");
  PENUMBRA_REAL_DATA(folder, "imagenet");
  const Classifier network(test::decode_product_quantised(weights_tools::load_weights(weights)));
  Arena arena;
  const nlohmann::json images = test::read_json(folder / "expected_pytorch.json")["images"];
  EXPECT_EQ(images.size(), 20U);
  for (const auto& [name, expected] : images.items()) {
    const std::vector<float> logits = network(read_image(folder / name, ImageColour::bgr), arena);
    const std::vector<int> top = expected["top5"];
    EXPECT_EQ(best_classes(logits, 5), top) << name;
    for (std::size_t i = 0; i < top.size(); ++i) {
      EXPECT_NEAR(logits[static_cast<std::size_t>(top[i])], expected["top5_logits"][i].get<float>(), 1e-3)
          << name;
    }
  }
}

TEST(Classifier, ImagesOfAnyShapeAreTaken) {
  const Classifier network(test::random_resnet(18, 8));
  Arena arena;
  for (const Size size : {Size{1, 1}, Size{1, 30000}, Size{30000, 1}, Size{256, 256}}) {
    EXPECT_EQ(network(ByteImage::filled(size.width, size.height, 7), arena).size(), 10U);
  }
  EXPECT_THROW(network(ByteImage(), arena), InputError);
  EXPECT_THROW(network(ByteImage::filled(4, 4, 0, 2), arena), InputError);
}

TEST(Classifier, OneErrorListsEveryTensorThatDoesNotFit) {
  StateDict weights = test::random_resnet(34, 8);
  weights.tensors.erase("layer3.5.conv1.weight");
  weights.tensors["fc.bias"].shape = {2, 5};
  weights.tensors["surprise"] = weights.tensors["bn1.bias"];
  test::expect_error<InputError>(
      [&] { Classifier network(weights); },
      {"weights of ResNet-34", "3 that do not fit", "missing layer3.5.conv1.weight",
       "fc.bias: expected shape [10], found [2, 5]", "surprise [8]"});
  test::expect_error<InputError>([] { Classifier network{StateDict{}}; },
                                 {"ResNet-50", "missing conv1.weight [64, 3, 7, 7]"});
}

TEST(Classifier, BestClassesTakesTiesInOrderAndNaNLast) {
  EXPECT_EQ(best_classes({1.0F, 3.0F, std::nanf(""), 3.0F}, 3), (std::vector{1, 3, 0}));
  EXPECT_EQ(best_classes({1.0F}, 5), (std::vector{0}));
  EXPECT_TRUE(best_classes({}, 5).empty());
}

}  // namespace
}  // namespace penumbra::nn
