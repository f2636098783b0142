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

TEST(ConvTranspose2d, WhoseKernelIsItsStrideAgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(3);
  for (std::uint32_t trial = 0; trial < 50; ++trial) {
    const int channels = pick(random, 1, 40), outputs = pick(random, 1, 70), stride = pick(random, 1, 3);
    const Tensor x =
        random_tensor({pick(random, 0, 3), channels, pick(random, 1, 9), pick(random, 1, 30)}, trial);
    const Tensor weight = random_tensor({channels, outputs, stride, stride}, 100 + trial);
    const std::vector<float> bias = random_vector(outputs, 200 + trial);
    ConvTranspose2dOptions options;
    options.stride = stride;
    options.activation = pick(random, 0, 1) == 1 ? Activation::relu : Activation::none;
    Arena arena;
    const FeatureMap y =
        ConvTranspose2d(weight, bias, options)(to_feature_map(x, arena, pick(random, 0, 1)), arena);
    test::expect_close(to_tensor(y), reference::conv_transpose2d(x, weight, bias, options));
  }
}

TEST(ConvTranspose2d, OfAnyKernelAgreesWithTheReferenceOnRandomShapes) {
  std::mt19937 random(4);
  for (std::uint32_t trial = 0; trial < 120; ++trial) {
    const int channels = pick(random, 1, 40), outputs = pick(random, 1, 40);
    const int kernel_h = pick(random, 1, 5), kernel_w = pick(random, 1, 5);
    ConvTranspose2dOptions options;
    options.stride = pick(random, 1, 4);
    options.dilation = pick(random, 1, 3);
    options.padding = pick(random, 0, 3);
    options.output_padding = pick(random, 0, std::max(options.stride, options.dilation) - 1);
    options.activation = trial % 3 == 0 ? Activation::silu : Activation::none;
    const Tensor x =
        random_tensor({pick(random, 0, 2), channels, pick(random, 1, 7), pick(random, 1, 12)}, trial);
    const auto extent = [&](std::int64_t in, int kernel) {
      return (in - 1) * options.stride - 2 * options.padding + options.dilation * (kernel - 1) +
             options.output_padding + 1;
    };
    if (extent(x.extent(2), kernel_h) < 1 || extent(x.extent(3), kernel_w) < 1) continue;
    const Tensor weight = random_tensor({channels, outputs, kernel_h, kernel_w}, 1000 + trial);
    const std::vector<float> bias = trial % 4 == 0 ? std::vector<float>{} : random_vector(outputs, trial);
    Arena arena;
    const FeatureMap y = ConvTranspose2d(weight, bias, options)(to_feature_map(x, arena, pick(random, 0, 2)),
                                                                arena, pick(random, 0, 1));
    test::expect_close(to_tensor(y), reference::conv_transpose2d(x, weight, bias, options));
  }
}

TEST(ConvTranspose2d, WrongShapesAreInputErrors) {
  EXPECT_THROW(ConvTranspose2d(random_tensor({8, 8}, 1), {}, {}), InputError);
  EXPECT_THROW(ConvTranspose2d(random_tensor({8, 8, 2, 2}, 1), random_vector(3, 1), {}), InputError);
  ConvTranspose2dOptions options;
  options.output_padding = 1;
  EXPECT_THROW(ConvTranspose2d(random_tensor({8, 8, 2, 2}, 1), {}, options), InputError);
  options = {};
  options.padding = 5;
  Arena arena;
  const FeatureMap map = to_feature_map(random_tensor({1, 8, 2, 2}, 1), arena);
  EXPECT_THROW(ConvTranspose2d(random_tensor({8, 8, 2, 2}, 1), {}, options)(map, arena), InputError);
  const ConvTranspose2d layer(random_tensor({24, 8, 2, 2}, 1), {}, {});
  EXPECT_THROW(layer(map, arena), InputError);
}

}  // namespace
}  // namespace penumbra::nn
