// AFNET, and the weights that ship, against an independent PyTorch module: see
// weights_tools/reference/make_afnet_fixtures.py.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/image/image_file.h"
#include "nn/models/make_network.h"
#include "tests/support/expect_error.h"
#include "tests/support/image_cases.h"
#include "tests/support/repeatability.h"
#include "tests/support/test_data.h"
#include "tests/support/yolov5_cases.h"
#include "weights_tools/load_weights.h"

namespace penumbra::nn {
namespace {

constexpr float kLeastScore = 0.25F;  // of the fixtures

test::RandomYolov5 small_afnet() { return {0.125, 1.0 / 3.0, 3, false, false, true, true}; }

class AfnetTest : public test::EveryIsa {};

TEST_P(AfnetTest, RandomWeightsGiveTheRowsAndPrototypesOfPyTorch) {
  for (const nlohmann::json& expected : test::read_json(test::fixture("afnet/random.json"))) {
    test::expect_random_outputs(expected);
  }
}

TEST_P(AfnetTest, WeightsThatShipFindInAnOfficeWhatPyTorchFinds) {
  const nlohmann::json fixtures = test::read_json(test::fixture("afnet/office.json"));
  EXPECT_FALSE(fixtures.empty());
  for (const nlohmann::json& expected : fixtures) {
    SCOPED_TRACE(expected["weights"]);
    NetworkConfig config;
    config.yolov5.score_threshold = kLeastScore;
    const auto network = make_network(
        weights_tools::load_weights(test::source_path(expected["weights"].get<std::string>())), config);
    const ByteImage image =
        read_image(test::fixture("afnet/" + expected["image"].get<std::string>()), ImageColour::bgr);
    const std::vector<Detection> found = (*network)(image);
    ASSERT_EQ(found.size(), expected["scores"].size());
    EXPECT_GT(found.size(), 5U);
    for (std::size_t i = 0; i < found.size(); ++i) {
      test::expect_detection(found, expected, i, expected["labels"][i].get<int>() + 1);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, AfnetTest, test::every_isa(), test::isa_name);

TEST(Afnet, IsToldByTheNamesOfItsWeights) {
  test::RandomYolov5 options{0.25, 1.0 / 3.0, 2};
  EXPECT_EQ(make_network(test::random_yolov5(options))->name(), "YOLOv5n");
  options.attention = true;
  EXPECT_EQ(make_network(test::random_yolov5(options))->name(), "YOLOv5n with coordinate attention");
  options.fusion = true;
  StateDict weights = test::random_yolov5(options);
  EXPECT_EQ(make_network(weights)->name(), "AFNET-n");
  weights.metadata["network"] = "afnet";
  EXPECT_EQ(make_network(weights)->name(), "AFNET-n");
  options.attention = false;
  EXPECT_EQ(make_network(test::random_yolov5(options))->name(), "YOLOv5n with ASFF");
  options = {0.5, 1.0 / 3.0, 2, true, true, true, true};
  EXPECT_EQ(make_network(test::random_yolov5(options))->name(), "AFNET-s-seg");

  weights.tensors.erase("asff.2.resize.0.conv.weight");
  weights.tensors["model.4.m.1.attention.expand_rows.bias"].shape = {4};
  test::expect_error<InputError>([&] { make_network(weights); },
                                 {"AFNET-n", "missing asff.2.resize.0.conv.weight [256, 64, 3, 3]",
                                  "model.4.m.1.attention.expand_rows.bias: expected shape [32]"});
}

TEST(Afnet, RepeatsBitForBitOnAnyNumberOfThreads) {
  Yolov5 network(test::random_yolov5(small_afnet()));
  const ByteImage image = test::random_image(4, 90, 70);
  EXPECT_FALSE(network(image).empty());
  test::expect_repeats_on_any_number_of_threads(network, image);
}

}  // namespace
}  // namespace penumbra::nn
