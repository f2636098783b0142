// AFNET, and the weights that ship, against an independent PyTorch module: see
// weights_tools/reference/make_afnet_fixtures.py.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>

#include "nn/base/error.h"
#include "nn/image/image_file.h"
#include "nn/io/safetensors.h"
#include "nn/models/make_network.h"
#include "nn/simd/low_precision.h"
#include "tests/support/expect_error.h"
#include "tests/support/image_cases.h"
#include "tests/support/repeatability.h"
#include "tests/support/test_data.h"
#include "tests/support/yolov5_cases.h"
#include "weights_tools/load_weights.h"

namespace penumbra::nn {
namespace {

constexpr float kLeastScore = 0.25F;  // of the fixtures,
constexpr int kLongestSide = 640;     // and their images' size at the network

test::RandomYolov5 small_afnet() { return {0.125, 1.0 / 3.0, 3, false, false, true, true}; }

class AfnetTest : public test::EveryIsa {};

TEST_P(AfnetTest, RandomWeightsGiveTheRowsAndPrototypesOfPyTorch) {
  for (const nlohmann::json& expected : test::read_json(test::fixture("afnet/random.json"))) {
    test::expect_random_outputs(expected);
  }
}

TEST_P(AfnetTest, WeightsThatShipFindInAnOfficeWhatPyTorchFinds) {
  const nlohmann::json fixtures = test::read_json(test::fixture("afnet/office.json"));
  EXPECT_EQ(fixtures.size(), 2U);
  for (const nlohmann::json& expected : fixtures) {
    SCOPED_TRACE(expected["weights"]);
    NetworkConfig config;
    config.yolov5.score_threshold = kLeastScore;
    config.yolov5.max_size = kLongestSide;
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

// What differs most between the boxes and scores of two precisions, over the detections of the first.
struct Difference {
  int compared = 0;
  float iou = 1.0F, score = 0.0F;
};
Difference difference(const std::vector<Detection>& exact, const std::vector<Detection>& found) {
  Difference worst;
  for (const Detection& a : exact) {
    if (a.score < kLeastScore) continue;
    ++worst.compared;
    float best = 0.0F, score = 0.0F;
    for (const Detection& b : found) {
      if (b.label != a.label || iou(a.box, b.box) <= best) continue;
      best = iou(a.box, b.box);
      score = b.score;
    }
    worst.iou = std::min(worst.iou, best);
    worst.score = std::max(worst.score, std::abs(score - a.score));
  }
  return worst;
}

TEST(Afnet, LowPrecisionFindsTheSameInAnOffice) {
  StateDict weights =
      weights_tools::load_weights(test::source_path("weights_tools/models/penumbra-afnet.safetensors"));
  const ByteImage image = read_image(test::fixture("afnet/office.jpg"), ImageColour::bgr);
  InputRanges ranges;
  Yolov5Config config;
  config.score_threshold = 0.1F;
  config.max_size = kLongestSide;
  config.precision.observed = &ranges;
  const std::vector<Detection> exact = Yolov5(weights, config)(image);
  EXPECT_TRUE(ranges.contains("asff.1.resize.0"));
  config.precision.observed = nullptr;
  store_input_ranges(ranges, weights);
  for (const auto& [precision, least_iou, most_score] :
       {std::tuple(Precision::bf16, 0.98F, 0.01F), std::tuple(Precision::int8, 0.88F, 0.05F)}) {
    if (!is_supported(precision)) continue;
    SCOPED_TRACE(to_string(precision));
    config.precision.precision = precision;
    const Difference worst = difference(exact, Yolov5(weights, config)(image));
    EXPECT_GT(worst.compared, 5);
    EXPECT_GT(worst.iou, least_iou);
    EXPECT_LT(worst.score, most_score);
  }
}

}  // namespace
}  // namespace penumbra::nn
