// Mask R-CNN against torchvision 0.14.1: see weights_tools/reference/make_mask_rcnn_fixtures.py.
#include "nn/models/mask_rcnn.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/evaluation/coco_rle.h"
#include "nn/image/image_file.h"
#include "tests/support/random_network.h"
#include "tests/support/repeatability.h"
#include "tests/support/runs.h"
#include "tests/support/test_data.h"
#include "weights_tools/load_weights.h"

namespace penumbra::nn {
namespace {

nlohmann::json read_fixture(const std::string& name) {
  return test::read_json(test::fixture("mask_rcnn/" + name));
}

// Whether rounding may move the mask's rectangle by a pixel: paste_mask truncates the corners of the grown
// box to whole pixels, as torchvision does, and here one lies so near a whole number that a tolerable
// difference of the box decides. The mask is then stretched by a pixel.
bool on_the_edge_of_a_pixel(const std::vector<float>& box, double box_tolerance) {
  constexpr double kGrowth = 30.0 / 28.0;
  for (const auto& [low, high] : {std::pair(box[0], box[2]), std::pair(box[1], box[3])}) {
    const double centre = (low + high) * 0.5, half = (high - low) * 0.5 * kGrowth;
    for (const double corner : {centre - half, centre + half}) {
      if (std::abs(corner - std::round(corner)) < box_tolerance) return true;
    }
  }
  return false;
}

struct Tolerance {
  double box, score, mask_iou;  // pixels, absolute, least overlap
};

// Every expected detection has one of ours, and we find none that is not expected. The fixtures leave out low
// scores: near the score threshold and the end of the list of 100, rounding decides which detections there
// are.
void expect_same(const std::vector<Detection>& found, const nlohmann::json& expected, const Size& image,
                 const Tolerance& tolerance) {
  for (std::size_t i = 0; i < expected["scores"].size(); ++i) {
    const float score = expected["scores"][i];
    const std::vector<float> box = expected["boxes"][i];
    const auto box_error = [&](const Detection& d) {
      return std::max({std::abs(d.box.x1 - box[0]), std::abs(d.box.y1 - box[1]), std::abs(d.box.x2 - box[2]),
                       std::abs(d.box.y2 - box[3])});
    };
    const Detection* nearest = nullptr;
    for (const Detection& d : found) {
      if (d.label == expected["labels"][i] && (nearest == nullptr || box_error(d) < box_error(*nearest)))
        nearest = &d;
    }
    ASSERT_NE(nearest, nullptr) << "detection " << i;
    EXPECT_LE(box_error(*nearest), tolerance.box) << "detection " << i;
    EXPECT_NEAR(nearest->score, score, tolerance.score) << "detection " << i;
    const std::vector<std::uint32_t> runs = expected["masks"][i];
    const double least_iou = on_the_edge_of_a_pixel(box, tolerance.box) ? 0.9 : tolerance.mask_iou;
    EXPECT_GT(test::mask_iou(mask_runs(nearest->mask, image.width, image.height), runs), least_iou)
        << "detection " << i;
  }
  const float least_score = expected["least_score"];
  const auto ours =
      std::count_if(found.begin(), found.end(), [&](const Detection& d) { return d.score >= least_score; });
  EXPECT_NEAR(static_cast<double>(ours), static_cast<double>(expected["scores"].size()), 1.0)
      << "a score may cross the line of comparison";
}

constexpr Tolerance kTolerance{0.02, 2e-4, 0.998};

void compare_random_network(bool attention, const MaskRcnnConfig& config, const std::string& fixture) {
  MaskRcnn network(test::random_mask_rcnn(attention), config);
  EXPECT_EQ(network.has_attention(), attention);
  for (const nlohmann::json& expected : read_fixture(fixture)) {
    const ByteImage image = test::random_image(expected["seed"], expected["width"], expected["height"]);
    SCOPED_TRACE(expected["seed"]);
    EXPECT_GT(expected["scores"].size(), 5U);
    expect_same(network(image), expected, image.size(), kTolerance);
  }
}

MaskRcnnConfig sized(int min_size, int max_size) {
  MaskRcnnConfig config;
  config.transform.min_size = min_size;
  config.transform.max_size = max_size;
  return config;
}

TEST(MaskRcnn, BaselineWithRandomWeightsFindsWhatTorchvisionFinds) {
  compare_random_network(false, sized(128, 224), "random_baseline.json");
}

TEST(MaskRcnn, MixedAttentionWithRandomWeightsFindsWhatPyTorchFinds) {
  compare_random_network(true, sized(128, 224), "random_attention.json");
}

TEST(MaskRcnn, BaselineAtFullSizeFindsWhatTorchvisionFinds) {
  compare_random_network(false, {}, "full_baseline.json");
}

TEST(MaskRcnn, MixedAttentionAtFullSizeFindsWhatPyTorchFinds) {
  compare_random_network(true, {}, "full_attention.json");
}

TEST(MaskRcnn, TrainedWeightsFindWhatTorchvisionFindsOnRealImages) {
  PENUMBRA_REAL_DATA(checkpoint, "weights/maskrcnn_r50fpn.pth");
  MaskRcnn network(weights_tools::load_weights(checkpoint));
  EXPECT_EQ(network.classes(), 91);
  for (const nlohmann::json& expected : read_fixture("trained.json")) {
    PENUMBRA_REAL_DATA(path, expected["image"].get<std::string>());
    SCOPED_TRACE(path);
    const ByteImage image = read_image(path, ImageColour::bgr);
    expect_same(network(image), expected, image.size(), kTolerance);
  }
}

TEST(MaskRcnn, TheSmallNetworkOfTheStreetFindsWhatPyTorchFinds) {
  MaskRcnn network(
      weights_tools::load_weights(test::source_path("weights_tools/models/penumbra-tiny.safetensors")));
  EXPECT_TRUE(network.has_attention());
  for (const nlohmann::json& expected : read_fixture("tiny.json")) {
    const auto path = test::fixture("mask_rcnn/" + expected["image"].get<std::string>());
    const ByteImage image = read_image(path, ImageColour::bgr);
    EXPECT_GT(expected["scores"].size(), 5U);
    expect_same(network(image), expected, image.size(), kTolerance);
  }
}

MaskRcnnConfig small_detector() { return sized(64, 128); }

TEST(MaskRcnn, AttentionLeftOutIsTheBaselineBitForBit) {
  StateDict weights = test::random_mask_rcnn(true);
  MaskRcnnConfig config = small_detector();
  config.attention = false;
  MaskRcnn without(weights, config);
  EXPECT_FALSE(without.has_attention());
  std::erase_if(weights.tensors,
                [](const auto& entry) { return entry.first.find("attention") != std::string::npos; });
  MaskRcnn baseline(weights, small_detector());
  const ByteImage image = test::random_image(3, 80, 60);
  test::expect_same_bits(without(image), baseline(image));
}

TEST(MaskRcnn, RepeatsBitForBitOnAnyNumberOfThreads) {
  MaskRcnn network(test::random_mask_rcnn(true), small_detector());
  const ByteImage image = test::random_image(4, 90, 70);
  EXPECT_FALSE(network(image).empty());
  test::expect_repeats_on_any_number_of_threads(network, image);
}

TEST(MaskRcnn, ImagesOfAnyShapeAreTaken) {
  MaskRcnn network(test::random_mask_rcnn(false), small_detector());
  for (const Size size : {Size{1, 1}, Size{1, 300}, Size{300, 1}, Size{64, 64}}) {
    EXPECT_LE(network(test::random_image(1, size.width, size.height)).size(), 100U)
        << size.width << " x " << size.height;
    EXPECT_LE(network(ByteImage::filled(size.width, size.height, 0)).size(), 100U);
  }
  EXPECT_THROW(network(ByteImage()), InputError);
  EXPECT_THROW(network(ByteImage::filled(4, 4, 0, 2)), InputError);
}

// NaN weights are refused when the network is made; large ones make NaN of the activations.
TEST(MaskRcnn, ActivationsThatAreNotANumberGiveNoDetections) {
  StateDict weights = test::random_mask_rcnn(false);
  std::vector<float> values(64 * 3 * 7 * 7, 1e37F);
  weights.tensors["backbone.body.conv1.weight"].bytes = std::as_bytes(std::span(values));
  MaskRcnn network(weights, small_detector());
  EXPECT_TRUE(network(test::random_image(1, 64, 48)).empty());
}

TEST(MaskRcnn, OneErrorListsEveryTensorThatDoesNotFit) {
  StateDict weights = test::random_mask_rcnn(false);
  weights.source = "bad.pth";
  weights.tensors.erase("rpn.head.cls_logits.bias");
  weights.tensors["backbone.body.bn1.weight"].shape = {8, 8};
  weights.tensors["surprise"] = weights.tensors["backbone.body.bn1.bias"];
  try {
    MaskRcnn network(weights);
    FAIL() << "the weights were taken";
  } catch (const InputError& error) {
    const std::string message = error.what();
    for (const char* part : {"bad.pth", "missing rpn.head.cls_logits.bias [3]",
                             "backbone.body.bn1.weight: expected shape [64], found [8, 8]",
                             "not part of the network: surprise [64]", "3 that do not fit"}) {
      EXPECT_NE(message.find(part), std::string::npos) << part << " in " << message;
    }
  }
}

TEST(MaskRcnn, WeightsWithTorchvisionsOldNamesAreTaken) {
  StateDict weights = test::random_mask_rcnn(false);
  const auto rename = [&](const std::string& from, const std::string& to) {
    for (const char* part : {".weight", ".bias"}) {
      auto entry = weights.tensors.extract(from + part);
      ASSERT_FALSE(entry.empty());
      entry.key() = to + part;
      weights.tensors.insert(std::move(entry));
    }
  };
  for (const std::string k : {"0", "1", "2", "3"}) {
    rename("backbone.fpn.inner_blocks." + k + ".0", "backbone.fpn.inner_blocks." + k);
    rename("backbone.fpn.layer_blocks." + k + ".0", "backbone.fpn.layer_blocks." + k);
    rename("roi_heads.mask_head." + k + ".0",
           "roi_heads.mask_head.mask_fcn" + std::to_string(std::stoi(k) + 1));
  }
  rename("rpn.head.conv.0.0", "rpn.head.conv");
  EXPECT_NO_THROW(MaskRcnn{weights});
}

TEST(MaskRcnn, TheEpsilonOfTheMetadataIsUsedAndChecked) {
  StateDict weights = test::random_mask_rcnn(false);
  for (const char* wrong : {"", "much", "-1", "1e-5 or so", "nan"}) {
    weights.metadata["batch_norm_eps"] = wrong;
    EXPECT_THROW(MaskRcnn{weights}, InputError) << wrong;
  }
  weights.metadata["batch_norm_eps"] = "0";
  EXPECT_NO_THROW(MaskRcnn{weights});
}

}  // namespace
}  // namespace penumbra::nn
