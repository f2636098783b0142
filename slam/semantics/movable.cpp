#include "slam/semantics/movable.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string>

namespace penumbra::slam {

bool is_movable_class(std::string_view class_name) {
  static constexpr std::array<std::string_view, 26> kMovable = {
      "person", "pedestrian", "rider", "cyclist", "bicycle",  "motorcycle", "car",   "van",    "bus",
      "train",  "tram",       "truck", "trailer", "caravan",  "airplane",   "boat",  "bird",   "cat",
      "dog",    "horse",      "sheep", "cow",     "elephant", "bear",       "zebra", "giraffe"};
  std::string lower(class_name);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kMovable.begin(), kMovable.end(), lower) != kMovable.end();
}

namespace {

// Whether the mask has a pixel within `margin` of (x, y): looks at the pixel and at eight around it.
bool touches(const Instance& instance, int x, int y, int margin) {
  for (const int dy : {-margin, 0, margin}) {
    for (const int dx : {-margin, 0, margin}) {
      if (instance.contains({x + dx, y + dy})) return true;
    }
  }
  return false;
}

}  // namespace

void mark_movable_features(const std::vector<Instance>& instances, const std::vector<Keypoint>& keypoints,
                           double least_score, int margin, std::vector<char>& movable) {
  for (const Instance& instance : instances) {
    if (instance.score < least_score || !is_movable_class(instance.class_name)) continue;
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
      const int x = static_cast<int>(std::lround(keypoints[i].u)),
                y = static_cast<int>(std::lround(keypoints[i].v));
      if (!movable[i] && touches(instance, x, y, margin)) movable[i] = 1;
    }
  }
}

}  // namespace penumbra::slam
