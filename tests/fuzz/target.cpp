#include "tests/fuzz/target.h"

#include <algorithm>
#include <array>

#include "nn/base/text.h"

namespace penumbra::fuzz {

namespace {

constexpr std::array kTargets = {
    Target{"pickle", read_pickle},
    Target{"torch_zip", read_torch_zip},
    Target{"torch_legacy", read_torch_legacy},
    Target{"safetensors", read_safetensors},
    Target{"coco_rle", read_coco_rle},
    Target{"image_container", read_image_container},
    Target{"image_file", read_image_file},
    Target{"number_file", read_number_file},
    Target{"kitti_calibration", read_kitti_calibration},
    Target{"trajectory", read_trajectory},
    Target{"class_names", read_class_names},
    Target{"frame_range", read_frame_range},
    Target{"coco_annotations", read_coco_annotations},
    Target{"coco_results", read_coco_results},
    Target{"map_file", read_map_file},
    Target{"cognitive_map", read_cognitive_map_file},
    Target{"odometry_file", read_odometry_file},
    Target{"plan_file", read_plan_file},
    Target{"camera_file", read_camera_file},
    Target{"image_list", read_image_list},
    Target{"euroc_ground_truth", read_euroc_ground_truth},
    Target{"recording", read_recording},
    Target{"message", read_message},
};

constexpr std::size_t kLongestMessage = 4096;  // bytes: 64 extents and 64 strides of 64 bits fit

}  // namespace

std::span<const Target> all_targets() { return kTargets; }

const Target& target_named(std::string_view name) {
  const auto found = std::find_if(kTargets.begin(), kTargets.end(),
                                  [&](const Target& target) { return target.name == name; });
  if (found == kTargets.end()) throw std::out_of_range("no fuzz target " + std::string(name));
  return *found;
}

void require_showable(std::string_view message) {
  const std::string shown = printable(message, message.size());
  require(shown == message, "an error's message is plain UTF-8: " + shown);
  require(message.size() <= kLongestMessage, "an error's message is short: " + printable(message));
}

}  // namespace penumbra::fuzz
