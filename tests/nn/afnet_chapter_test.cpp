// The worked examples of docs/dynamics/afnet.md: every number there is checked here.
#include <gtest/gtest.h>

#include "nn/layers/asff.h"
#include "nn/layers/coordinate_attention.h"

namespace penumbra::nn {
namespace {

void expect_example(const FeatureMap& map, const std::vector<float>& expected) {
  const std::vector<float> values = to_tensor(map).values;
  ASSERT_EQ(values.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(values[i], expected[i], 5e-5F) << i;
}

TEST(AfnetChapter, CoordinateAttention) {
  const Tensor one({1, 1, 1, 1}, {1}), minus_one({1, 1, 1, 1}, {-1});
  const CoordinateAttention attention({one, {}, one, {-4}, minus_one, {4}});
  Arena arena;
  FeatureMap map = to_feature_map(Tensor({1, 1, 2, 2}, {1, 3, 5, 7}), arena);
  attention.apply(map, arena);
  expect_example(map, {0.0646F, 0.0713F, 3.2196F, 1.6582F});
}

TEST(AfnetChapter, Asff) {
  const Tensor one({1, 1, 1, 1}, {1});
  Arena arena;
  const FeatureMap fine = to_feature_map(Tensor({1, 1, 2, 2}, {1, 4, 4, 1}), arena);
  const FeatureMap coarse = to_feature_map(Tensor({1, 1, 1, 1}, {3}), arena);
  const FeatureMap* levels[] = {&fine, &coarse};
  expect_example(Asff(std::vector<Tensor>{one, one}, {})(levels, arena),
                 {2.7616F, 3.7311F, 3.7311F, 2.7616F});
}

}  // namespace
}  // namespace penumbra::nn
