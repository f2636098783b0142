#include "slam/dynamics/movable.h"

#include <algorithm>
#include <array>
#include <string>

#include "nn/base/text.h"

namespace penumbra::slam {

bool is_movable_class(std::string_view class_name) {
  static constexpr std::array<std::string_view, 26> kMovable = {
      "person", "pedestrian", "rider", "cyclist", "bicycle",  "motorcycle", "car",   "van",    "bus",
      "train",  "tram",       "truck", "trailer", "caravan",  "airplane",   "boat",  "bird",   "cat",
      "dog",    "horse",      "sheep", "cow",     "elephant", "bear",       "zebra", "giraffe"};
  return std::find(kMovable.begin(), kMovable.end(), lower_case(class_name)) != kMovable.end();
}

bool is_vehicle_class(std::string_view class_name) {
  static constexpr std::array<std::string_view, 10> kVehicles = {
      "bicycle", "car", "van", "bus", "train", "tram", "truck", "trailer", "caravan", "boat"};
  return std::find(kVehicles.begin(), kVehicles.end(), lower_case(class_name)) != kVehicles.end();
}

double moving_prior(std::string_view class_name) {
  if (!is_movable_class(class_name)) return -4.0;
  return is_vehicle_class(class_name) ? 0.4 : 2.0;
}

}  // namespace penumbra::slam
