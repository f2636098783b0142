// Small COCO files for tests.
#pragma once

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "nn/evaluation/coco_evaluation.h"
#include "tests/support/test_data.h"

namespace penumbra::test {

using Rectangle = std::array<double, 4>;  // x, y, width, height

// A data set of 400 x 300 pixel images 1, 2, ... with one category more than are used, and results for it.
class CocoFiles {
 public:
  explicit CocoFiles(int images = 1) {
    for (int i = 1; i <= images; ++i) {
      annotations["images"].push_back(
          {{"id", i}, {"width", 400}, {"height", 300}, {"file_name", std::to_string(i) + ".png"}});
    }
    annotations["categories"] = {
        {{"id", 3}, {"name", "car"}}, {{"id", 7}, {"name", "train"}}, {{"id", 1}, {"name", "person"}}};
    annotations["annotations"] = nlohmann::json::array();
    results = nlohmann::json::array();
  }

  static nlohmann::json polygon(const Rectangle& r) {
    return {{r[0], r[1], r[0] + r[2], r[1], r[0] + r[2], r[1] + r[3], r[0], r[1] + r[3]}};
  }
  void add_object(const Rectangle& r, int image = 1, int category = 1, bool is_crowd = false) {
    annotations["annotations"].push_back({{"id", annotations["annotations"].size() + 1},
                                          {"image_id", image},
                                          {"category_id", category},
                                          {"bbox", r},
                                          {"area", r[2] * r[3]},
                                          {"iscrowd", is_crowd ? 1 : 0},
                                          {"segmentation", polygon(r)}});
  }
  void add_result(const Rectangle& r, double score, int image = 1, int category = 1) {
    results.push_back({{"image_id", image},
                       {"category_id", category},
                       {"bbox", r},
                       {"score", score},
                       {"segmentation", polygon(r)}});
  }

  std::string annotations_path() const { return folder / "instances.json"; }
  std::string results_path() const { return folder / "results.json"; }
  void write() const {
    std::ofstream(annotations_path()) << annotations;
    std::ofstream(results_path()) << results;
  }
  nn::CocoNumbers evaluate(nn::CocoRegion region = nn::CocoRegion::boxes,
                           const std::optional<nn::OcclusionRange>& occlusion = std::nullopt,
                           nn::CocoRules rules = nn::CocoRules::official) const {
    write();
    const nn::CocoAnnotations truth = nn::read_coco_annotations(annotations_path());
    return nn::evaluate_coco(truth, nn::read_coco_results(results_path(), truth, rules), region, occlusion,
                             rules);
  }

  TemporaryDirectory folder;
  nlohmann::json annotations, results;
};

}  // namespace penumbra::test
