// YOLOv5 against an independent PyTorch module: see weights_tools/reference/make_yolov5_fixtures.py.
#include "nn/models/yolov5.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/evaluation/coco_evaluation.h"
#include "nn/evaluation/coco_rle.h"
#include "nn/image/image_file.h"
#include "nn/models/coco_categories.h"
#include "tests/support/expect_error.h"
#include "tests/support/random_models.h"
#include "tests/support/random_network.h"
#include "tests/support/repeatability.h"
#include "tests/support/runs.h"
#include "tests/support/test_data.h"
#include "tests/support/yolov5_cases.h"
#include "weights_tools/load_weights.h"

namespace penumbra::nn {
namespace {

TEST(Yolov5, RandomWeightsGiveTheRowsAndPrototypesOfPyTorch) {
  for (const nlohmann::json& expected : test::read_json(test::fixture("yolov5/random.json"))) {
    test::expect_random_outputs(expected);
  }
}

TEST(Yolov5, PublishedWeightsFindWhatPyTorchFindsOnRealImages) {
  for (const nlohmann::json& expected : test::read_json(test::fixture("yolov5/trained.json"))) {
    PENUMBRA_REAL_DATA(checkpoint, expected["checkpoint"].get<std::string>());
    PENUMBRA_REAL_DATA(path, expected["image"].get<std::string>());
    SCOPED_TRACE(path);
    Yolov5Config config;
    config.score_threshold = 0.25F;
    Yolov5 network(weights_tools::load_weights(checkpoint), config);
    EXPECT_EQ(network.classes(), 91);
    const ByteImage image = read_image(path, ImageColour::bgr);
    const std::vector<Detection> found = network(image);
    const std::size_t count = expected["scores"].size();
    ASSERT_EQ(found.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      const int label = category_of_class(expected["labels"][i], kCocoClasses);
      const Detection* match = test::expect_detection(found, expected, i, label);
      ASSERT_NE(match, nullptr);
      EXPECT_EQ(match->mask.bits.empty(), !expected.contains("masks"));
      if (!expected.contains("masks")) continue;
      const std::vector<std::uint32_t> runs = expected["masks"][i];
      EXPECT_GT(test::mask_iou(mask_runs(match->mask, image.width(), image.height()), runs), 0.998);
    }
  }
}

TEST(Yolov5, AveragePrecisionOnCocoIsTheOneExpected) {
  PENUMBRA_REAL_DATA(checkpoint, "weights/yolov5n-seg_fused_state_dict_fp16.pth");
  PENUMBRA_REAL_DATA(folder, "coco");
  const nlohmann::json expected = test::read_json(folder / "expected_coco.json");
  const CocoAnnotations annotations = read_coco_annotations(folder / "instances_val2017_80.json");
  Yolov5 network(weights_tools::load_weights(checkpoint));
  CocoResultsWriter writer;
  for (const CocoImage& entry : annotations.images) {
    const auto id = std::get<std::int64_t>(entry.id);
    const ByteImage image = read_image(folder / "images" / fmt::format("{:012}.jpg", id), ImageColour::bgr);
    for (const Detection& detection : network(image)) {
      writer.add(id, detection.label, detection, image.width(), image.height());
    }
  }
  const test::TemporaryDirectory scratch;
  writer.write(scratch / "results.json");
  const CocoResults results = read_coco_results(scratch / "results.json", annotations);
  EXPECT_NEAR(evaluate_coco(annotations, results, CocoRegion::boxes)["AP"], expected["bbox"]["AP"], 0.003);
  EXPECT_NEAR(evaluate_coco(annotations, results, CocoRegion::masks)["AP"], expected["segm"]["AP"], 0.003);
}

TEST(Yolov5, RepeatsBitForBitOnAnyNumberOfThreads) {
  Yolov5 network(test::random_yolov5({0.125, 1.0 / 3.0, 4, true, false}));
  const ByteImage image = test::random_image(4, 90, 70);
  EXPECT_FALSE(network(image).empty());
  test::expect_repeats_on_any_number_of_threads(network, image);
}

TEST(Yolov5, ImagesOfAnyShapeAreTakenAndDetectionsLieInsideThem) {
  Yolov5Config config;
  config.letterbox.size = 96;
  Yolov5 network(test::random_yolov5({0.125, 1.0 / 3.0, 2, true, true}), config);
  for (const Size size : {Size{1, 1}, Size{1, 3000}, Size{3000, 1}, Size{96, 64}}) {
    for (const Detection& d : network(test::random_image(1, size.width, size.height))) {
      EXPECT_TRUE(d.box.x1 >= 0 && d.box.y1 >= 0 && d.box.x2 <= static_cast<float>(size.width) &&
                  d.box.y2 <= static_cast<float>(size.height));
      EXPECT_LE(d.mask.x + d.mask.width, size.width);
      EXPECT_LE(d.mask.y + d.mask.height, size.height);
      EXPECT_TRUE(d.label >= 1 && d.label < network.classes());
    }
    EXPECT_NO_THROW(network(ByteImage::filled(size.width, size.height, 0)));
  }
  EXPECT_THROW(network(ByteImage()), InputError);
  EXPECT_THROW(network(ByteImage::filled(4, 4, 0, 2)), InputError);
}

TEST(Yolov5, TakesTheSizeOfItsImagesFromTheUserElseFromTheWeights) {
  StateDict weights = test::random_yolov5({0.125, 1.0 / 3.0, 2, true, false});
  EXPECT_EQ(Yolov5(weights).longest_side(), 640);
  weights.metadata["max_size"] = "416";
  EXPECT_EQ(Yolov5(weights).longest_side(), 416);
  Yolov5Config config;
  config.max_size = 320;
  EXPECT_EQ(Yolov5(weights, config).longest_side(), 320);
  for (const char* wrong : {"", "0", "many", "1e9"}) {
    weights.metadata["max_size"] = wrong;
    EXPECT_THROW(Yolov5(weights, config), InputError) << wrong;
  }
}

// NaN weights are refused when the network is made; large ones make NaN of the activations.
TEST(Yolov5, ActivationsThatAreNotANumberGiveNoDetections) {
  StateDict weights = test::random_yolov5({0.125, 1.0 / 3.0, 2, true, true});
  const std::vector<float> values(8 * 3 * 6 * 6, 1e38F);
  weights.tensors["model.0.conv.weight"].bytes = std::as_bytes(std::span(values));
  Yolov5 network(weights);
  EXPECT_TRUE(network(test::random_image(1, 64, 48)).empty());
}

TEST(Yolov5, OneErrorListsEveryTensorThatDoesNotFit) {
  StateDict weights = test::random_yolov5({0.25, 1.0 / 3.0, 80, true, false});
  weights.source = "bad.pth";
  weights.tensors.erase("model.9.cv2.conv.weight");
  weights.tensors["model.0.bn.weight"].shape = {4, 4};
  weights.tensors["surprise"] = weights.tensors["model.0.bn.bias"];
  test::expect_error<InputError>([&] { Yolov5 network(weights); },
                                 {"bad.pth", "weights of YOLOv5n-seg", "3 that do not fit",
                                  "missing model.9.cv2.conv.weight [256, 512, 1, 1]",
                                  "model.0.bn.weight: expected shape [16], found [4, 4]", "surprise [16]"});
  EXPECT_THROW(Yolov5{StateDict{}}, InputError);
}

TEST(Yolov5, ShapesAreThoseOfThePublishedModels) {
  EXPECT_EQ(yolov5_shape(0.25, 1.0 / 3.0, 80, false).name(), "YOLOv5n");
  const Yolov5Shape medium = yolov5_shape(0.75, 2.0 / 3.0, 80, true);
  EXPECT_EQ(medium.name(), "YOLOv5m-seg");
  EXPECT_EQ(medium.channels, (std::array{48, 96, 192, 384, 768}));
  EXPECT_EQ(medium.backbone_repetitions, (std::array{2, 4, 6, 2}));
  EXPECT_EQ(yolov5_shape(1.25, 4.0 / 3.0, 80, false).backbone_repetitions, (std::array{4, 8, 12, 4}));
}

}  // namespace
}  // namespace penumbra::nn
