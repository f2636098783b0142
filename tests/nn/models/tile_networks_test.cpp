// Whole networks on a tile unit, narrow maps from layer to layer: on the emulation, which any machine has,
// and bit for bit the same on the processor's own where there is one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/image/image_file.h"
#include "nn/io/image_transform.h"
#include "nn/layers/narrow_maps.h"
#include "nn/models/mask_rcnn.h"
#include "nn/models/yolov5.h"
#include "nn/simd/isa.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/random_models.h"
#include "tests/support/random_network.h"
#include "tests/support/repeatability.h"
#include "tests/support/test_data.h"
#include "weights_tools/load_weights.h"

namespace penumbra::nn {
namespace {

class TileNetworksTest : public ::testing::TestWithParam<std::tuple<Precision, bool>> {
 protected:
  void SetUp() override {
    const auto path = test::fixture(
        "mask_rcnn/" +
        test::read_json(test::fixture("mask_rcnn/tiny.json")).at(0)["image"].get<std::string>());
    image_ = read_image(path, ImageColour::bgr);
    config_.attention = std::get<1>(GetParam());
    config_.min_size = 128;  // the emulation is slow
    config_.proposals = 60;
    config_.box_head.max_detections = 20;
    config_.box_head.score_threshold = 0.0F;  // so that there are masks, whatever is found
    weights_ =
        weights_tools::load_weights(test::source_path("weights_tools/models/penumbra-tiny.safetensors"));
    InputRanges ranges;
    MaskRcnnConfig observing = config_;
    observing.precision.observed = &ranges;
    expected_ = MaskRcnn(weights_, observing)(image_);
    store_input_ranges(ranges, weights_);
    use_isa(Isa::amx_emulated);
    config_.precision.precision = std::get<0>(GetParam());
  }
  void TearDown() override { use_isa(before_); }

  Isa before_ = current_isa();
  ByteImage image_;
  StateDict weights_;
  MaskRcnnConfig config_;
  std::vector<Detection> expected_;  // in f32
};

double square_sum(const Tensor& tensor) {
  return std::inner_product(tensor.values.begin(), tensor.values.end(), tensor.values.begin(), 0.0);
}

// The pyramid's maps, with the rounding of some fifty layers; without attention their sums are narrow, too.
TEST_P(TileNetworksTest, MakeThePyramidOfF32) {
  MaskRcnnConfig config = config_;
  config.precision.precision = Precision::f32;
  const MaskRcnn exact(weights_, config), network(weights_, config_);
  const auto pyramid = [&](const MaskRcnn& of, Arena& arena) {
    ImageTransform transform = config_.transform;
    transform.min_size = *config_.min_size;
    FeatureMap input = transform_image(image_, transform, arena, ResNet::kImageBorder);
    return of.pyramid(std::move(input), arena);
  };
  Arena arena;
  const auto expected = pyramid(exact, arena), found = pyramid(network, arena);
  for (std::size_t level = 0; level < found.size(); ++level) {
    EXPECT_EQ(found[level].numbers().precision, config_.precision.precision);
    const Tensor values = to_tensor(in_numbers(found[level], {}, arena));
    Tensor error = to_tensor(expected[level]);
    const double size = square_sum(error);
    for (std::size_t i = 0; i < error.values.size(); ++i) error.values[i] -= values.values[i];
    const double tolerance = config_.precision.precision == Precision::bf16 ? 0.03 : 0.12;
    EXPECT_LT(std::sqrt(square_sum(error) / size), tolerance) << "P" << level + 2;
  }
}

TEST_P(TileNetworksTest, FindWhatTheNetworkFindsInF32) {
  if (!config_.attention) GTEST_SKIP() << "finds little without the attention that it was trained with";
  MaskRcnn network(weights_, config_);
  const std::vector<Detection> found = network(image_);
  const bool bf16 = config_.precision.precision == Precision::bf16;
  const float least_overlap = bf16 ? 0.9F : 0.75F, score_tolerance = bf16 ? 0.03F : 0.1F;
  int compared = 0;
  for (const Detection& expected : expected_) {
    if (expected.score < 0.5F) continue;
    ++compared;
    const bool same = std::any_of(found.begin(), found.end(), [&](const Detection& d) {
      return d.label == expected.label && iou(d.box, expected.box) > least_overlap &&
             std::abs(d.score - expected.score) < score_tolerance;
    });
    EXPECT_TRUE(same) << "score " << expected.score << " at " << expected.box.x1 << ", " << expected.box.y1;
  }
  EXPECT_GE(compared, 3);
  if (!is_supported(Isa::amx)) return;
  use_isa(Isa::amx);
  MaskRcnn real(weights_, config_);
  test::expect_same_bits(real(image_), found);
}

TEST_P(TileNetworksTest, RepeatBitForBitOnAnyNumberOfThreadsAndAllocateNothing) {
  const MaskRcnn network(weights_, config_);
  Arena arena;
  std::vector<Detection> found;
  network.detect(image_, arena, found);
  const std::vector<Detection> expected = found;
  const std::size_t before = test::allocation_count();
  network.detect(image_, arena, found);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(arena.recordings(), 1U);
  test::expect_same_bits(found, expected);
  const int threads = thread_count();
  set_thread_count(threads + 1);
  network.detect(image_, arena, found);
  set_thread_count(threads);
  test::expect_same_bits(found, expected);
}

INSTANTIATE_TEST_SUITE_P(Every, TileNetworksTest,
                         ::testing::Combine(::testing::Values(Precision::bf16, Precision::int8),
                                            ::testing::Bool()),
                         [](const auto& info) {
                           return std::string(to_string(std::get<0>(info.param))) +
                                  (std::get<1>(info.param) ? "_with_attention" : "");
                         });

// YOLOv5's maps are f32 between most layers: each converts what it reads.
TEST(TileNetworks, YolosMapsAreConverted) {
  const StateDict weights = test::random_yolov5({0.25, 1.0 / 3.0, 4, true, false});
  const ByteImage image = test::random_image(1, 96, 64);
  Yolov5Config config;
  config.max_size = 96;
  const std::vector<Detection> expected = Yolov5(weights, config)(image);
  const Isa before = current_isa();
  use_isa(Isa::amx_emulated);
  config.precision.precision = Precision::bf16;
  const std::vector<Detection> found = Yolov5(weights, config)(image);
  use_isa(before);
  ASSERT_FALSE(expected.empty());
  EXPECT_NEAR(static_cast<double>(found.size()), static_cast<double>(expected.size()),
              0.2 * static_cast<double>(expected.size()));
  EXPECT_NEAR(found.front().score, expected.front().score, 0.02F);
}

TEST(Precision, AutoTakesWhatIsFastest) {
  const Isa before = current_isa();
  StateDict weights, calibrated;
  calibrated.metadata["input_range.layer"] = "0,1";
  const LayerPrecision automatic{Precision::f32, nullptr, true};
  use_isa(Isa::amx_emulated);
  EXPECT_EQ(automatic.resolved(weights).precision, Precision::bf16);
  EXPECT_EQ(automatic.resolved(calibrated).precision, Precision::int8);
  EXPECT_EQ((LayerPrecision{Precision::bf16, nullptr}).resolved(calibrated).precision, Precision::bf16);
  use_isa(Isa::avx2);
  EXPECT_EQ(automatic.resolved(calibrated).precision, Precision::f32);
  EXPECT_THROW((LayerPrecision{Precision::bf16, nullptr}).resolved(weights), UsageError);
  if (is_supported(Isa::avx512)) {
    use_isa(Isa::avx512);
    if (is_supported(Precision::bf16)) {
      const Bf16Arithmetic arithmetic = bf16_arithmetic();
      use_bf16_arithmetic(Bf16Arithmetic::dot_products);
      EXPECT_EQ(automatic.resolved(weights).precision, Precision::bf16);
      use_bf16_arithmetic(Bf16Arithmetic::f32);
      EXPECT_EQ(automatic.resolved(weights).precision, Precision::f32);
      EXPECT_EQ(automatic.resolved(calibrated).precision, Precision::int8);
      EXPECT_EQ((LayerPrecision{Precision::bf16, nullptr}).resolved(weights).precision, Precision::f32);
      use_bf16_arithmetic(arithmetic);
    }
  }
  use_isa(before);
}

}  // namespace
}  // namespace penumbra::nn
