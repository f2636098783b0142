// Against Pillow: see weights_tools/reference/make_classifier_fixtures.py.
#include "nn/io/antialiased_resize.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "tests/support/random_network.h"
#include "tests/support/test_data.h"

namespace penumbra::nn {
namespace {

TEST(AntialiasedResize, EqualsPillowInEveryPixel) {
  std::ifstream file(test::fixture("classifier/pillow_resize.json"));
  for (const nlohmann::json& expected : nlohmann::json::parse(file)) {
    const ByteImage image = test::random_image(expected["seed"], expected["image"][0], expected["image"][1]);
    const std::vector<int> w = expected["window"];
    Arena arena;
    const ArenaVector<std::uint8_t> found = antialiased_resize(
        image, {expected["size"][0], expected["size"][1]}, {w[0], w[1], w[2], w[3]}, arena);
    EXPECT_EQ(std::vector(found.begin(), found.end()), expected["pixels"].get<std::vector<std::uint8_t>>())
        << expected["image"];
  }
}

TEST(AntialiasedResize, WindowsOutsideTheResultAreAnError) {
  const ByteImage image = test::random_image(1, 8, 8);
  Arena arena;
  EXPECT_THROW(antialiased_resize(image, {4, 4}, {1, 0, 4, 4}, arena), InputError);
  EXPECT_THROW(antialiased_resize(image, {4, 4}, {}, arena), InputError);
  EXPECT_THROW(antialiased_resize({}, {4, 4}, {0, 0, 4, 4}, arena), InputError);
}

}  // namespace
}  // namespace penumbra::nn
