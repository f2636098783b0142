// What PyTorch modules of YOLOv5 and AFNET found, against what the engine finds: fixtures as
// weights_tools/reference/make_yolov5_fixtures.py writes them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "nn/models/yolov5.h"
#include "tests/support/random_models.h"
#include "tests/support/random_network.h"

namespace penumbra::test {

inline RandomYolov5 random_options(const nlohmann::json& expected) {
  return {expected["width"],
          expected["depth"],
          expected["classes"],
          expected["masks"],
          expected["folded"],
          expected.value("attention", false),
          expected.value("fusion", false)};
}

// Row of the PyTorch module's output: level by level, anchor by anchor, row by row.
inline std::size_t row_index(const nn::Yolov5Output& output, const nn::Yolov5Candidate& c) {
  std::size_t before = 0;
  for (int level = 0; level < c.level; ++level) {
    const nn::FeatureMap& map = output.levels[static_cast<std::size_t>(level)];
    before += static_cast<std::size_t>(3 * map.height() * map.width());
  }
  const nn::FeatureMap& map = output.levels[static_cast<std::size_t>(c.level)];
  return before + static_cast<std::size_t>((c.anchor * map.height() + c.row) * map.width() + c.column);
}

// Rows and prototype pixels of a network with random weights.
inline void expect_random_outputs(const nlohmann::json& expected) {
  SCOPED_TRACE(expected["seed"]);
  const nn::Yolov5 network(random_yolov5(random_options(expected)));
  const int classes = expected["classes"];
  EXPECT_EQ(network.shape().classes, classes);
  EXPECT_EQ(network.has_masks(), expected["masks"].get<bool>());
  nn::Arena arena;
  const ByteImage image = random_image(expected["seed"], expected["size"][0], expected["size"][1]);
  nn::Letterbox letterbox;
  letterbox.size = std::max(image.width(), image.height());  // as it is
  const nn::Yolov5Output output =
      network.forward(nn::letterbox_image(image, letterbox, arena, nn::Yolov5Features::kImageBorder), arena);

  constexpr std::size_t kAll = 100000;
  const nn::ArenaVector<nn::Yolov5Candidate> candidates = network.head().decode(output, -1.0F, kAll, arena);
  EXPECT_LT(candidates.size(), kAll);
  std::size_t compared = 0;
  for (const nn::Yolov5Candidate& candidate : candidates) {
    const std::string index = std::to_string(row_index(output, candidate));
    if (!expected["rows"].contains(index)) continue;
    const std::vector<double> row = expected["rows"][index];
    const nn::Box& box = candidate.box;
    EXPECT_NEAR((box.x1 + box.x2) / 2, row[0], 2e-3) << index;
    EXPECT_NEAR((box.y1 + box.y2) / 2, row[1], 2e-3) << index;
    EXPECT_NEAR(box.width(), row[2], 2e-3 * std::max(row[2] / 100, 1.0)) << index;
    EXPECT_NEAR(box.height(), row[3], 2e-3 * std::max(row[3] / 100, 1.0)) << index;
    EXPECT_NEAR(candidate.score, row[4] * row[static_cast<std::size_t>(5 + candidate.label)], 5e-5) << index;
    if (network.has_masks()) {
      const auto coefficients = network.head().coefficients(output, candidate);
      for (std::size_t k = 0; k < coefficients.size(); ++k) {
        EXPECT_NEAR(coefficients[k], row[static_cast<std::size_t>(5 + classes) + k], 1e-4) << index;
      }
    }
    ++compared;
  }
  EXPECT_EQ(compared, expected["rows"].size() * static_cast<std::size_t>(classes));
  if (!network.has_masks()) return;
  const std::vector<float> prototypes = nn::to_tensor(output.prototypes).values;
  for (const auto& [index, value] : expected["prototypes"].items()) {
    EXPECT_NEAR(prototypes[std::stoul(index)], value.get<float>(), 2e-5) << index;
  }
}

inline float box_error(const nn::Box& box, const std::vector<float>& expected) {
  return std::max({std::abs(box.x1 - expected[0]), std::abs(box.y1 - expected[1]),
                   std::abs(box.x2 - expected[2]), std::abs(box.y2 - expected[3])});
}

// The detection that is the fixture's number i: label, box to 0.02 pixels and score to 2e-4; null, and a
// failure, where there is none.
inline const nn::Detection* expect_detection(const std::vector<nn::Detection>& found,
                                             const nlohmann::json& expected, std::size_t i, int label) {
  const std::vector<float> box = expected["boxes"][i];
  const auto match = std::find_if(found.begin(), found.end(), [&](const nn::Detection& d) {
    return d.label == label && box_error(d.box, box) < 0.02F;
  });
  if (match == found.end()) {
    ADD_FAILURE() << "no detection " << i;
    return nullptr;
  }
  EXPECT_NEAR(match->score, expected["scores"][i].get<float>(), 2e-4);
  return &*match;
}

}  // namespace penumbra::test
