// The interest network against an independent PyTorch module: see
// weights_tools/reference/make_interest_fixtures.py.
#include "nn/models/interest_network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/image/image_file.h"
#include "tests/support/expect_error.h"
#include "tests/support/image_cases.h"
#include "tests/support/random_models.h"
#include "tests/support/random_network.h"
#include "tests/support/test_data.h"
#include "weights_tools/load_weights.h"

namespace penumbra::nn {
namespace {

void expect_values(const nlohmann::json& expected, const std::vector<float>& values, float tolerance) {
  for (const auto& [index, value] : expected.items()) {
    ASSERT_LT(std::stoul(index), values.size());
    EXPECT_NEAR(values[std::stoul(index)], value.get<float>(), tolerance) << index;
  }
}

class InterestNetworkTest : public test::EveryIsa {};

TEST_P(InterestNetworkTest, RandomWeightsGiveThePyTorchOutputs) {
  for (const nlohmann::json& expected : test::read_json(test::fixture("interest/random.json"))) {
    SCOPED_TRACE(expected["seed"]);
    const InterestNetwork network(
        test::random_interest({expected["channels"], expected["classes"], expected["embedding"],
                               expected["attention"], expected["folded"]}));
    EXPECT_EQ(network.classes(), expected["classes"].get<int>());
    EXPECT_EQ(network.embedding(), expected["embedding"].get<int>());
    EXPECT_EQ(network.has_attention(), expected["attention"].get<bool>());
    const ByteImage image = test::random_image(expected["seed"], expected["size"][0], expected["size"][1]);
    Letterbox letterbox;
    letterbox.size = std::max(image.width(), image.height());  // as it is
    letterbox.stride = 16;
    Arena arena;
    const InterestNetwork::Output output =
        network.forward(letterbox_image(image, letterbox, arena, InterestNetwork::kImageBorder), arena);
    expect_values(expected["logits"], to_tensor(output.logits).values, 1e-4F);
    expect_values(expected["vectors"], to_tensor(output.embedding).values, 1e-4F);
  }
}

TEST_P(InterestNetworkTest, WeightsThatShipSeeInAStreetWhatPyTorchSees) {
  const nlohmann::json expected = test::read_json(test::fixture("interest/street.json"));
  const std::filesystem::path file = test::source_path(expected["weights"].get<std::string>());
  EXPECT_LE(std::filesystem::file_size(file), 4'000'000U);
  const InterestNetwork network(weights_tools::load_weights(file));
  EXPECT_LE(network.multiply_adds(192, 624), 0.5e9);
  const ByteImage image =
      read_image(test::fixture("interest/" + expected["image"].get<std::string>()), ImageColour::bgr);
  Arena arena;
  InterestMap map;
  network(image, arena, map);
  EXPECT_EQ(map.width, expected["width"].get<int>());
  EXPECT_EQ(map.height, expected["height"].get<int>());
  expect_values(expected["probabilities"], map.probabilities, 2e-4F);
  expect_values(expected["embeddings"], map.embeddings, 5e-4F);
}

INSTANTIATE_TEST_SUITE_P(Isa, InterestNetworkTest, test::every_isa(), test::isa_name);

TEST(InterestNetwork, CellsCoverImagesOfAnyShapeAndHoldProbabilitiesAndUnitVectors) {
  InterestConfig config;
  config.most_pixels = 5000.0;
  const InterestNetwork network(test::random_interest(), config);
  Arena arena;
  InterestMap map;
  for (const Size size : {Size{1, 1}, Size{1, 300}, Size{300, 1}, Size{97, 64}, Size{640, 480}}) {
    SCOPED_TRACE(testing::Message() << size.width << " x " << size.height);
    network(test::random_image(1, size.width, size.height), arena, map);
    ASSERT_GE(map.width * map.height, 1);
    EXPECT_LE(map.width * map.height * 64.0, 2.0 * 5000.0 + 8.0 * 8.0 * (map.width + map.height));
    // No border cell lies wholly outside of the image.
    EXPECT_LE(map.left, 0.0F);
    EXPECT_GT(map.left + map.size, 0.0F);
    EXPECT_LE(map.top, 0.0F);
    EXPECT_GT(map.top + map.size, 0.0F);
    const float right = map.left + map.size * static_cast<float>(map.width);
    const float bottom = map.top + map.size * static_cast<float>(map.height);
    EXPECT_GT(right, 0.98F * static_cast<float>(size.width));
    EXPECT_GT(bottom, 0.98F * static_cast<float>(size.height));
    EXPECT_LT(right - map.size, static_cast<float>(size.width));
    EXPECT_LT(bottom - map.size, static_cast<float>(size.height));
    const auto cells = static_cast<std::size_t>(map.width * map.height);
    ASSERT_EQ(map.probabilities.size(), cells * 11);
    ASSERT_EQ(map.embeddings.size(), cells * 32);
    for (std::size_t cell = 0; cell < cells; ++cell) {
      float sum = 0.0F, squares = 0.0F;
      for (std::size_t c = 0; c < 11; ++c) sum += map.probabilities[cell * 11 + c];
      for (std::size_t c = 0; c < 32; ++c)
        squares += map.embeddings[cell * 32 + c] * map.embeddings[cell * 32 + c];
      EXPECT_NEAR(sum, 1.0F, 1e-5F);
      EXPECT_NEAR(squares, 1.0F, 1e-5F);
    }
  }
  EXPECT_THROW(network(ByteImage(), arena, map), InputError);
  EXPECT_THROW(network(ByteImage::filled(4, 4, 0, 2), arena, map), InputError);
}

TEST(InterestNetwork, ReadsGreyImagesAsColourOnesOfThreeEqualChannels) {
  const InterestNetwork network(test::random_interest());
  const ByteImage grey = test::noise_image(64, 48);
  ByteImage colour(64, 48, 3);
  for (std::size_t i = 0; i < colour.elements(); ++i) colour.data()[i] = grey.data()[i / 3];
  Arena arena;
  InterestMap one, three;
  network(grey, arena, one);
  network(colour, arena, three);
  EXPECT_EQ(one.probabilities, three.probabilities);
}

TEST(InterestNetwork, RepeatsBitForBitOnAnyNumberOfThreads) {
  const InterestNetwork network(test::random_interest());
  const ByteImage image = test::random_image(4, 200, 90);
  const int threads = thread_count();
  Arena arena;
  InterestMap first, again;
  network(image, arena, first);
  for (const int count : {1, 2, 3}) {
    set_thread_count(count);
    network(image, arena, again);
    EXPECT_EQ(again.probabilities, first.probabilities);
    EXPECT_EQ(again.embeddings, first.embeddings);
  }
  set_thread_count(threads);
}

TEST(InterestNetwork, RefusesWeightsThatAreNotWholeByName) {
  EXPECT_TRUE(is_interest_network(test::random_interest()));
  EXPECT_FALSE(is_interest_network(test::random_yolov5({})));
  StateDict weights = test::random_interest();
  weights.tensors.erase("lateral.weight");
  test::expect_error<InputError>([&] { const InterestNetwork network(weights); }, {"lateral.weight"});
  weights = test::random_interest();
  weights.tensors["stranger"] = weights.tensors["lateral.bias"];
  test::expect_error<InputError>([&] { const InterestNetwork network(weights); }, {"stranger"});
  weights = test::random_interest();
  weights.metadata["network"] = "yolov5";
  EXPECT_THROW(InterestNetwork{weights}, InputError);
}

}  // namespace
}  // namespace penumbra::nn
