// Which topics of a recording are the two cameras, or the camera and its depth.
//
//   stereo        names that are the same but for left/right, cam0/cam1, infra1/infra2 and the like; depth in
//                 neither
//   RGB-D         a depth topic and an image topic that it is registered to: one K and size in both camera
//                 infos, or a name with "aligned" or "registered", or one frame
//   camera info   the topic camera_info (info/camera_info, as librealsense has it) in the image's own
//                 namespace
//
// Of several the best is taken: with camera infos before without; left and right before depth, and depth
// before two infrared cameras, which see the projector's dots; rectified before raw; raw bytes before JPEG;
// grey or colour as asked for. Options decide otherwise.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slam/sources/bag/bag_index.h"
#include "slam/sources/open_dataset.h"

namespace penumbra::slam {

struct ChosenTopics {
  Sensor sensor = Sensor::stereo;
  const ImageTopic* left = nullptr;    // or the image beside the depth
  const ImageTopic* second = nullptr;  // right, or depth
  const CameraTopic* left_camera = nullptr;
  const CameraTopic* second_camera = nullptr;
  bool is_registered = true;  // the depth, as far as is known

  std::string text() const;  // for notes: the topics and why
};

// None where nothing fits; `reason` then says why. Throws InputError where an option names a topic that is
// not there.
std::optional<ChosenTopics> choose_topics(const BagIndex& index, const DatasetOptions& options,
                                          const std::string& place, std::string& reason);

}  // namespace penumbra::slam
