// penumbra segment on real photographs with published weights: how well, not only that it runs.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "nn/simd/low_precision.h"
#include "tests/support/test_data.h"

namespace penumbra::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kWeights = "weights/yolov5n-seg_fused_state_dict_fp16.pth";

// Average precision of boxes and masks, in 0..1.
std::pair<double, double> average_precision(const fs::path& coco, const fs::path& weights,
                                            const std::string& precision, const fs::path& out) {
  const std::string annotations = (coco / "instances_val2017_80.json").string();
  const ProgramResult segment =
      run_penumbra("segment --coco-images " + (coco / "images").string() + " --annotations " + annotations +
                   " --weights " + weights.string() + " --precision " + precision + " --out " + out.string());
  EXPECT_EQ(segment.exit_code, 0) << segment.err;
  const ProgramResult evaluation = run_penumbra("eval-coco --json --annotations " + annotations +
                                                " --results " + (out / "results.json").string());
  EXPECT_EQ(evaluation.exit_code, 0) << evaluation.err;
  const json numbers = json::parse(evaluation.out);
  return {numbers["bbox"]["AP"], numbers["segm"]["AP"]};
}

TEST(SegmentRealTest, SmallerNumbersKeepTheAveragePrecision) {
  if (!nn::is_supported(nn::Precision::int8) || !nn::is_supported(nn::Precision::bf16)) {
    GTEST_SKIP() << "no bf16 and int8 on this processor";
  }
  PENUMBRA_REAL_DATA(weights, kWeights);
  PENUMBRA_REAL_DATA(coco, "coco");
  const TemporaryDirectory folder;
  const fs::path calibrated = folder / "int8.safetensors";
  std::string images;
  std::vector<fs::path> all(fs::directory_iterator(coco / "images"), {});
  std::sort(all.begin(), all.end());
  all.resize(20);
  for (const fs::path& image : all) images += fmt::format(" {}", image.string());
  const ProgramResult calibrate =
      run_penumbra("calibrate" + images + " --weights " + weights.string() + " -o " + calibrated.string());
  ASSERT_EQ(calibrate.exit_code, 0) << calibrate.err;

  const auto [boxes, masks] = average_precision(coco, weights, "f32", folder / "f32");
  const auto [bf16_boxes, bf16_masks] = average_precision(coco, weights, "bf16", folder / "bf16");
  const auto [int8_boxes, int8_masks] = average_precision(coco, calibrated, "int8", folder / "int8");
  EXPECT_GT(bf16_boxes, boxes - 0.003);
  EXPECT_GT(bf16_masks, masks - 0.003);
  EXPECT_GT(int8_boxes, boxes - 0.01);
  EXPECT_GT(int8_masks, masks - 0.01);
}

// Two people walk through ten frames of TUM's fr3_walking_halfsphere.
TEST(SegmentRealTest, FindsBothPeopleInEveryWalkingFrame) {
  PENUMBRA_REAL_DATA(weights, kWeights);
  PENUMBRA_REAL_DATA(images, "tum/rgbd_dataset_freiburg3_walking_halfsphere_10/rgb");
  const TemporaryDirectory folder;
  const ProgramResult result = run_penumbra("segment " + images.string() + "/*.png --weights " +
                                            weights.string() + " --out " + folder.path().string());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::map<std::string, int> people;
  for (const json& found : read_json(folder / "results.json")) {
    people[found["image_id"].dump()] += found["category_id"] == 1 && found["score"].get<double>() > 0.4;
  }
  EXPECT_EQ(people.size(), 10U);
  for (const auto& [image, count] : people) EXPECT_EQ(count, 2) << image;
}

}  // namespace
}  // namespace penumbra::test
