// What `penumbra segment` says about its run: lines for people as it goes, JSON for machines at the end.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "nn/image/image.h"
#include "nn/models/mask_rcnn.h"

namespace penumbra::apps {

struct SegmentedImage {
  std::filesystem::path path;
  Size size;
  const std::vector<nn::Detection>& detections;
  double seconds = 0.0;                          // of the network alone
  std::optional<std::filesystem::path> picture;  // where one was drawn
};

// Two kinds of line: the image, and each of its instances with a score of at least `show_above`.
std::string image_text(const SegmentedImage& image, const std::vector<std::string>& names, float show_above);

// {"path", "width", "height", "instances", "seconds", "picture"?,
//  "shown"?: [{"class", "label", "score", "box": [x1, y1, x2, y2]}, ...]}
// "instances" counts all; "shown" lists those with a score of at least `show_above`, where that is given.
nlohmann::ordered_json image_json(const SegmentedImage& image, const std::vector<std::string>& names,
                                  std::optional<float> show_above);

}  // namespace penumbra::apps
