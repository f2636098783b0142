#include "nn/layers/conv_transpose2d.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/layers/reference/reference.h"
#include "tests/support/tensors.h"

namespace penumbra::nn {
namespace {

using test::pick;
using test::random_tensor;
using test::random_vector;

TEST(ConvTranspose2d, AgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(3);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const int channels = pick(random, 1, 40), outputs = pick(random, 1, 70), stride = pick(random, 1, 3);
    const Tensor x =
        random_tensor({pick(random, 0, 3), channels, pick(random, 1, 9), pick(random, 1, 30)}, trial);
    const Tensor weight = random_tensor({channels, outputs, stride, stride}, 100 + trial);
    const std::vector<float> bias = random_vector(outputs, 200 + trial);
    const Activation activation = pick(random, 0, 1) == 1 ? Activation::relu : Activation::none;
    Arena arena;
    const FeatureMap y =
        ConvTranspose2d(weight, bias, activation)(to_feature_map(x, arena, pick(random, 0, 1)), arena);
    test::expect_close(to_tensor(y), reference::conv_transpose2d(x, weight, bias, activation));
  }
}

TEST(ConvTranspose2d, WrongShapesAreInputErrors) {
  EXPECT_THROW(ConvTranspose2d(random_tensor({8, 8, 2, 3}, 1), {}, Activation::none), InputError);
  EXPECT_THROW(ConvTranspose2d(random_tensor({8, 8, 2, 2}, 1), random_vector(3, 1), Activation::none),
               InputError);
  Arena arena;
  const ConvTranspose2d layer(random_tensor({8, 8, 2, 2}, 1), {}, Activation::none);
  EXPECT_THROW(layer(to_feature_map(random_tensor({1, 24, 5, 5}, 1), arena), arena), InputError);
}

}  // namespace
}  // namespace penumbra::nn
