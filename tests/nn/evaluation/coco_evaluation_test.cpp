// COCO's numbers on cases that can be reckoned by hand, and on real data against the official evaluation.
#include "nn/evaluation/coco_evaluation.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/evaluation/coco_rle.h"
#include "tests/support/coco_files.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

using nn::CocoNumbers;
using nn::CocoRegion;

TEST(CocoEvaluation, PerfectDetectionsScoreOne) {
  CocoFiles files(2);
  const Rectangle small{10, 10, 20, 20}, medium{50, 50, 60, 40}, large{100, 20, 200, 150};
  int image = 1;
  for (const Rectangle& box : {small, medium, large, small}) {
    files.add_object(box, image);
    files.add_result(box, 0.9, image);
    image = 3 - image;
  }
  for (const CocoRegion region : {CocoRegion::boxes, CocoRegion::masks}) {
    const CocoNumbers numbers = files.evaluate(region);
    for (const std::string_view name : nn::kCocoNumberNames) {
      // Each image has two objects of the category, so its best detection alone finds half of them.
      EXPECT_NEAR(numbers[name], name == "AR1" ? 0.5 : 1.0, 1e-12) << name;
    }
  }
}

TEST(CocoEvaluation, TheWorkedExampleOfTheChapter) {
  CocoFiles files;
  files.add_object({0, 0, 100, 100});
  files.add_object({200, 0, 100, 100});
  files.add_result({0, 0, 100, 82}, 0.9);    // IoU 0.82 with the first
  files.add_result({0, 200, 50, 50}, 0.8);   // nothing there
  files.add_result({200, 0, 62, 100}, 0.7);  // IoU 0.62 with the second
  const double both = (51 * 1.0 + 50 * 2.0 / 3.0) / 101, one = 51.0 / 101;
  for (const CocoRegion region : {CocoRegion::boxes, CocoRegion::masks}) {
    const CocoNumbers numbers = files.evaluate(region);
    EXPECT_NEAR(numbers["AP50"], 0.8350, 5e-5);
    EXPECT_NEAR(numbers["AP75"], 0.5050, 5e-5);
    EXPECT_NEAR(numbers["AP"], 0.4525, 5e-5);
    EXPECT_NEAR(numbers["AP"], (3 * both + 4 * one) / 10, 1e-12);
    EXPECT_NEAR(numbers["AR100"], (3 * 1.0 + 4 * 0.5) / 10, 1e-12);
    EXPECT_NEAR(numbers["AR1"], 7 * 0.5 / 10, 1e-12);
  }
}

TEST(CocoEvaluation, AFalsePositiveAboveHalvesThePrecision) {
  CocoFiles files;
  files.add_object({10, 10, 50, 50});
  files.add_result({200, 100, 50, 50}, 0.9);
  files.add_result({10, 10, 50, 50}, 0.8);
  EXPECT_NEAR(files.evaluate()["AP"], 0.5, 1e-12);
  files.results[0]["score"] = 0.1;  // below, it costs nothing
  EXPECT_NEAR(files.evaluate()["AP"], 1.0, 1e-12);
}

// Two objects of which 10 % and 50 % are hidden; detections of both and of nothing.
struct HalfHiddenObjects : CocoFiles {
  HalfHiddenObjects() {
    add_object({10, 10, 50, 50});
    add_object({200, 10, 50, 50});
    annotations["annotations"][0]["occlusion"] = 0.1;
    annotations["annotations"][1]["occlusion"] = 0.5;
    add_result({10, 10, 50, 50}, 0.9);
    add_result({200, 10, 50, 50}, 0.8);
    add_result({100, 200, 50, 50}, 0.85);
  }
};

TEST(CocoEvaluation, ObjectsOutsideTheOcclusionRangeAreNeitherHitNorMistake) {
  const HalfHiddenObjects files;
  for (const CocoRegion region : {CocoRegion::boxes, CocoRegion::masks}) {
    EXPECT_NEAR(files.evaluate(region)["AP"], (51 + 50 * 2.0 / 3.0) / 101, 1e-12);
    EXPECT_NEAR(files.evaluate(region, nn::OcclusionRange{0.0, 0.3})["AP"], 1.0, 1e-12);
    EXPECT_NEAR(files.evaluate(region, nn::OcclusionRange{0.3, 0.6})["AP"], 0.5, 1e-12)
        << "the detection of nothing stands above it";
    EXPECT_EQ(files.evaluate(region, nn::OcclusionRange{0.6, 0.9})["AP"], nn::kNoObjects);
  }
}

TEST(CocoEvaluation, AnOcclusionRangeHasItsLowerBoundAndNotItsUpper) {
  const HalfHiddenObjects files;
  EXPECT_NEAR(files.evaluate(CocoRegion::boxes, nn::OcclusionRange{0.5, 0.6})["AP"], 0.5, 1e-12);
  EXPECT_EQ(files.evaluate(CocoRegion::boxes, nn::OcclusionRange{0.3, 0.5})["AP"], nn::kNoObjects);
  EXPECT_TRUE((nn::OcclusionRange{0.9, 1.0}.contains(1.0))) << "nothing lies beyond 1";
}

TEST(CocoEvaluation, OcclusionRangesNeedTheHiddenShareOfEveryObject) {
  HalfHiddenObjects files;
  files.annotations["annotations"][1].erase("occlusion");
  expect_error<InputError>(
      [&] {
        files.evaluate(CocoRegion::boxes, nn::OcclusionRange{0.0, 0.3});
      },
      {"instances.json: annotations, entry 1"});
  files.annotations["annotations"][1]["iscrowd"] = 1;
  EXPECT_NO_THROW(files.evaluate(CocoRegion::boxes, nn::OcclusionRange{0.0, 0.3}));
  for (const double wrong : {-0.1, 1.5}) {
    files.annotations["annotations"][1]["occlusion"] = wrong;
    expect_error<InputError>([&] { files.evaluate(); }, {"occlusion"});
  }
}

TEST(CocoEvaluation, ASecondDetectionOfAnObjectIsAFalsePositive) {
  CocoFiles files;
  files.add_object({10, 10, 50, 50});
  files.add_object({200, 10, 50, 50});
  files.add_result({10, 10, 50, 50}, 0.9);
  files.add_result({10, 10, 50, 50}, 0.8);
  files.add_result({200, 10, 50, 50}, 0.7);
  EXPECT_NEAR(files.evaluate()["AP"], (51 + 50 * 2.0 / 3.0) / 101, 1e-12);
}

TEST(CocoEvaluation, EqualScoresKeepTheOrderOfTheFile) {
  CocoFiles files;
  files.add_object({10, 10, 50, 50});
  files.add_result({200, 100, 50, 50}, 0.5);
  files.add_result({10, 10, 50, 50}, 0.5);
  EXPECT_NEAR(files.evaluate()["AP"], 0.5, 1e-12);
  std::swap(files.results[0], files.results[1]);
  EXPECT_NEAR(files.evaluate()["AP"], 1.0, 1e-12);
}

TEST(CocoEvaluation, DetectionsInACrowdAreNeitherRightNorWrong) {
  CocoFiles files;
  files.add_object({0, 0, 200, 200}, 1, 1, true);
  files.add_object({250, 10, 50, 50});
  files.add_result({0, 0, 30, 30}, 0.9);  // wholly in the crowd: overlap 1 by its own area
  files.add_result({50, 50, 30, 30}, 0.8);
  files.add_result({250, 10, 50, 50}, 0.7);
  EXPECT_NEAR(files.evaluate()["AP"], 1.0, 1e-12);
  EXPECT_NEAR(files.evaluate(CocoRegion::masks)["AP"], 1.0, 1e-12);
  files.annotations["annotations"][0]["iscrowd"] = 0;  // an object now: two false positives above
  EXPECT_LT(files.evaluate()["AP"], 0.5);
}

TEST(CocoEvaluation, AnObjectInACrowdIsTakenBeforeTheCrowd) {
  CocoFiles files;
  files.add_object({0, 0, 200, 200}, 1, 1, true);
  files.add_object({20, 20, 50, 50});
  files.add_result({20, 20, 50, 40}, 0.9);  // IoU 0.8 with the object, 1 with the crowd
  const CocoNumbers numbers = files.evaluate();
  EXPECT_NEAR(numbers["AP50"], 1.0, 1e-12);
  EXPECT_NEAR(numbers["AR100"], 0.7, 1e-12);
}

TEST(CocoEvaluation, RangesOfAreaIncludeBothEndsAndIgnoreWhatLiesOutside) {
  CocoFiles files;
  files.add_object({0, 0, 32, 32});        // 32^2: small and medium
  files.add_object({100, 100, 150, 150});  // large
  files.add_result({0, 0, 32, 32}, 0.5);
  files.add_result({300, 200, 80, 80}, 0.9);  // a false positive of medium size
  const CocoNumbers numbers = files.evaluate();
  EXPECT_NEAR(numbers["APs"], 1.0, 1e-12);
  EXPECT_NEAR(numbers["APm"], 0.5, 1e-12);
  EXPECT_NEAR(numbers["APl"], 0.0, 1e-12);
  EXPECT_NEAR(numbers["ARs"], 1.0, 1e-12);
  EXPECT_NEAR(numbers["ARl"], 0.0, 1e-12);
}

TEST(CocoEvaluation, CategoriesAndRangesWithoutObjectsAreLeftOut) {
  CocoFiles files;
  files.add_object({0, 0, 20, 20}, 1, 7);
  files.add_result({0, 0, 20, 20}, 0.5, 1, 7);
  files.add_result({50, 50, 20, 20}, 0.9, 1, 3);  // no object of this category
  const CocoNumbers numbers = files.evaluate();
  EXPECT_NEAR(numbers["AP"], 1.0, 1e-12);
  EXPECT_EQ(numbers["APl"], nn::kNoObjects);
  CocoFiles nothing;
  EXPECT_EQ(nothing.evaluate()["AP"], nn::kNoObjects);
  nothing.add_object({0, 0, 20, 20});
  EXPECT_EQ(nothing.evaluate()["AP"], 0.0);
}

TEST(CocoEvaluation, OnlyTheBest100DetectionsOfAnImageCount) {
  CocoFiles files;
  files.add_object({0, 0, 20, 20});
  for (int i = 0; i < 100; ++i) files.add_result({200, 100, 20, 20}, 0.9);
  files.add_result({0, 0, 20, 20}, 0.1);
  EXPECT_EQ(files.evaluate()["AR100"], 0.0);
  files.results.erase(0);
  EXPECT_NEAR(files.evaluate()["AR100"], 1.0, 1e-12);
  EXPECT_EQ(files.evaluate()["AR10"], 0.0);
}

TEST(CocoEvaluation, AllFormsOfSegmentationGiveTheSameNumbers) {
  CocoFiles files;
  files.add_object({1, 2, 3, 4});
  files.add_result({1, 2, 3, 4}, 0.5);
  const nlohmann::json size = {300, 400};
  const nlohmann::json counts = {302, 4, 296, 4, 296, 4, 400 * 300 - 906};
  for (const nlohmann::json& form :
       {nlohmann::json{{"size", size}, {"counts", counts}},
        nlohmann::json{{"size", size},
                       {"counts", nn::encode_runs(counts.get<std::vector<std::uint32_t>>())}}}) {
    files.results[0]["segmentation"] = form;
    EXPECT_NEAR(files.evaluate(CocoRegion::masks)["AP"], 1.0, 1e-12);
    files.results[0].erase("bbox");  // taken from the mask then
    EXPECT_NEAR(files.evaluate()["AP"], 1.0, 1e-12);
  }
}

TEST(CocoEvaluation, MasksWithoutSegmentationAreAnErrorThatNamesTheEntry) {
  CocoFiles files;
  files.add_object({1, 2, 3, 4});
  for (int i = 0; i < 2; ++i) files.add_result({1, 2, 3, 4}, 0.5);
  files.results[1].erase("segmentation");
  EXPECT_NO_THROW(files.evaluate());
  expect_error<InputError>([&] { files.evaluate(CocoRegion::masks); },
                           {"results.json: entry 1: expected a segmentation"});
}

// Numbers of pycocotools 2.0.
TEST(CocoEvaluation, AnObjectOfId0IsNeverFoundByTheOfficialRules) {
  CocoFiles files;
  files.add_object({10, 10, 40, 40});
  files.add_object({100, 100, 40, 40});
  files.add_result({10, 10, 40, 40}, 0.9);
  files.add_result({100, 100, 40, 40}, 0.8);
  files.annotations["annotations"][0]["id"] = 0;
  const double half = 0.5 * 51.0 / 101.0;  // recall stays at 0.5, and precision there is 1/2
  EXPECT_NEAR(files.evaluate()["AP"], half, 1e-12);
  EXPECT_NEAR(files.evaluate()["AR100"], 0.5, 1e-12);
  EXPECT_EQ(files.evaluate(CocoRegion::boxes, std::nullopt, nn::CocoRules::sensible)["AP"], 1.0);
}

TEST(CocoEvaluation, TheFirstResultDecidesByTheOfficialRulesWhatGivesTheArea) {
  // The mask is small, the box large: a detection that finds nothing counts in the size of its area.
  CocoFiles files;
  files.add_object({10, 10, 10, 10});
  for (int i = 0; i < 2; ++i) files.add_result({10, 10, 10, 10}, 0.5);
  files.results[0].erase("bbox");
  files.results[1] = {{"image_id", 1},
                      {"category_id", 1},
                      {"score", 0.9},
                      {"bbox", {200, 100, 50, 50}},
                      {"segmentation", CocoFiles::polygon({200, 100, 20, 20})}};
  EXPECT_NEAR(files.evaluate()["APs"], 0.5, 1e-12);
  EXPECT_NEAR(files.evaluate(CocoRegion::boxes, std::nullopt, nn::CocoRules::sensible)["APs"], 1.0, 1e-12);
}

TEST(CocoEvaluation, WhatIsNotComparedMayBeMissingOrFaulty) {
  CocoFiles files;
  files.add_object({10, 10, 40, 40});
  files.add_result({10, 10, 40, 40}, 0.9);
  const nlohmann::json annotations = files.annotations;
  files.annotations["annotations"][0]["segmentation"] = {10, 10, 50, 10, 50, 50};
  files.annotations["images"][0].erase("width");
  EXPECT_EQ(files.evaluate()["AP"], 1.0);
  EXPECT_THROW(files.evaluate(CocoRegion::masks), InputError);
  files.annotations = annotations;
  files.annotations["annotations"][0].erase("bbox");
  EXPECT_EQ(files.evaluate(CocoRegion::masks)["AP"], 1.0);
  expect_error<InputError>([&] { files.evaluate(); }, {"annotations, entry 0, bbox"});
}

TEST(CocoEvaluation, FloatsAndIdsThatAreNotListedAreTakenAsTheOfficialToolDoes) {
  CocoFiles files;
  files.add_object({10, 10, 40, 40});
  files.add_object({10, 10, 40, 40}, 99);
  files.add_object({10, 10, 40, 40}, 1, 77);
  files.add_result({10, 10, 40, 40}, 0.9);
  files.add_result({10, 10, 40, 40}, 0.95, 1, 77);
  files.annotations["images"][0]["width"] = 400.0;
  files.annotations["annotations"][0]["image_id"] = 1.0;
  files.annotations["annotations"][0]["iscrowd"] = 0.0;
  files.results[0]["category_id"] = 1.0;
  EXPECT_EQ(files.evaluate()["AP"], 1.0);
  const nn::CocoAnnotations truth = nn::read_coco_annotations(files.annotations_path());
  EXPECT_EQ(truth.of_unknown_images, 1U);
  EXPECT_EQ(truth.of_unknown_categories, 1U);
  EXPECT_EQ(nn::read_coco_results(files.results_path(), truth).of_unknown_categories, 1U);
}

TEST(CocoEvaluation, APolygonOfTwoPointsIsAPartAndNotTheWhole) {
  CocoFiles files;
  files.add_object({10, 10, 40, 40});
  files.add_result({10, 10, 40, 40}, 0.9);
  files.annotations["annotations"][0]["segmentation"].push_back({60, 60, 70, 70});
  EXPECT_EQ(files.evaluate(CocoRegion::masks)["AP"], 1.0);
  files.annotations["annotations"][0]["segmentation"] = {{60, 60, 70, 70}};
  EXPECT_THROW(files.evaluate(CocoRegion::masks), InputError);
}

TEST(CocoEvaluation, AgreesWithTheOfficialEvaluationOnRealData) {
  PENUMBRA_REAL_DATA(folder, "coco");
  const nn::CocoAnnotations annotations = nn::read_coco_annotations(folder / "instances_val2017_80.json");
  const nn::CocoResults results = nn::read_coco_results(folder / "results_yolov5n_seg.json", annotations);
  std::ifstream file(folder / "expected_coco.json");
  const nlohmann::json expected = nlohmann::json::parse(file);
  const CocoNumbers boxes = nn::evaluate_coco(annotations, results, CocoRegion::boxes);
  const CocoNumbers masks = nn::evaluate_coco(annotations, results, CocoRegion::masks);
  for (const std::string_view name : nn::kCocoNumberNames) {
    EXPECT_NEAR(boxes[name], expected["bbox"][std::string(name)].get<double>(), 1e-9) << "boxes " << name;
    EXPECT_NEAR(masks[name], expected["segm"][std::string(name)].get<double>(), 1e-9) << "masks " << name;
  }
}

}  // namespace
}  // namespace penumbra::test
