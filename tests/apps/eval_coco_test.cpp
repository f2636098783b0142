// `penumbra eval-coco` from the outside: table, JSON and exit codes.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/bytes.h"
#include "tests/support/coco_files.h"

namespace penumbra::test {
namespace {

class EvalCoco : public testing::Test {
 protected:
  EvalCoco() {
    files_.add_object({0, 0, 100, 100});
    files_.add_object({200, 0, 100, 100});
    files_.add_result({0, 0, 100, 82}, 0.9);
    files_.add_result({0, 200, 50, 50}, 0.8);
    files_.add_result({200, 0, 62, 100}, 0.7);
  }
  ProgramResult eval(const std::string& more = "") const {
    files_.write();
    return run_penumbra("eval-coco --annotations " + files_.annotations_path() + " --results " +
                        files_.results_path() + " " + more);
  }
  CocoFiles files_;
};

TEST_F(EvalCoco, PrintsATableForPeople) {
  const ProgramResult result = eval();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const char* part :
       {"1 image, 2 objects and 0 crowds, 3 detections", "boxes", "masks", "AP50", "0.8350", "0.4525", "-"}) {
    EXPECT_CONTAINS(result.out, part);
  }
}

TEST_F(EvalCoco, PrintsJsonForMachines) {
  const nlohmann::json report = nlohmann::json::parse(eval("--json").out);
  EXPECT_EQ(report["detections"], 3);
  for (const char* type : {"bbox", "segm"}) {
    EXPECT_NEAR(report[type]["AP"].get<double>(), 0.4525, 5e-5);
    EXPECT_TRUE(report[type]["APs"].is_null());
    EXPECT_EQ(report[type].size(), 12U);
  }
}

TEST_F(EvalCoco, TheTypeSaysWhatIsCompared) {
  EXPECT_FALSE(nlohmann::json::parse(eval("--json --type bbox").out).contains("segm"));
  EXPECT_FALSE(nlohmann::json::parse(eval("--json --type segm").out).contains("bbox"));
  for (auto& result : files_.results) result.erase("segmentation");
  EXPECT_FALSE(nlohmann::json::parse(eval("--json").out).contains("segm"));
  const ProgramResult failed = eval("--type both");
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_EQ(failed.out, "");
  EXPECT_CONTAINS(failed.err, "results.json: entry 0: expected a segmentation");
  EXPECT_EQ(eval("--type keypoints").exit_code, 2);
}

TEST_F(EvalCoco, ReportsApByTheHiddenShareOfTheObjects) {
  files_.annotations["annotations"][0]["occlusion"] = 0.2;
  files_.annotations["annotations"][1]["occlusion"] = 0.7;
  const nlohmann::json report = nlohmann::json::parse(eval("--json --occlusion 0,0.3,0.6,0.9").out);
  ASSERT_EQ(report["occlusion"].size(), 3U);
  EXPECT_EQ(report["occlusion"][0]["objects"], 1);
  EXPECT_EQ(report["occlusion"][2]["from"], 0.6);
  EXPECT_NEAR(report["occlusion"][0]["bbox"]["AP"].get<double>(), 0.7, 1e-9);  // IoU 0.82: 7 of 10 thresholds
  EXPECT_NEAR(report["occlusion"][0]["segm"]["AP"].get<double>(), 0.7, 1e-9);
  EXPECT_TRUE(report["occlusion"][1]["bbox"]["AP"].is_null());
  EXPECT_CONTAINS(eval("--occlusion 0,0.3,0.6,0.9").out, "0.6 to 0.9  1 object ");
  EXPECT_FALSE(nlohmann::json::parse(eval("--json").out).contains("occlusion"));
}

TEST_F(EvalCoco, OcclusionRangesMustRiseAndNeedTheirKey) {
  for (const char* wrong : {"0.5", "0.3,0.3", "0,0.6,0.3", "0,2", "a,b"}) {
    EXPECT_EQ(eval(std::string("--occlusion ") + wrong).exit_code, 2) << wrong;
  }
  const ProgramResult result = eval("--occlusion 0,1");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_CONTAINS(result.err, "annotations, entry 0");
}

TEST_F(EvalCoco, WrongFilesAndArgumentsAreErrors) {
  files_.results[2]["image_id"] = 5;
  const ProgramResult result = eval();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_CONTAINS(result.err, "results.json: entry 2, image_id");
  EXPECT_EQ(run_penumbra("eval-coco --annotations x.json").exit_code, 2);
  EXPECT_EQ(run_penumbra("eval-coco --annotations /no/file --results /no/file").exit_code, 1);
}

}  // namespace
}  // namespace penumbra::test
