// A stereo drive through the synthetic street, frame by frame, and the writer of its KITTI layout.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "slam/datasets/synthetic/camera_sensor.h"
#include "slam/datasets/synthetic/instance_masks.h"
#include "slam/datasets/synthetic/ray_caster.h"
#include "slam/datasets/synthetic/street_builder.h"

namespace penumbra::slam::synthetic {

struct SequenceSettings {
  std::string preset = "street";
  std::string path = "block";  // "block", "straight" or a KITTI pose file
  int frames = 0;              // 0: 60, or all of a pose file
  cv::Size size{620, 188};     // pixels
  std::uint32_t seed = 1;
  bool colour = false;       // image_2 and image_3 as well
  bool depth = false;        // depth of the left image as well
  bool annotations = false;  // COCO instances of the left images
};

// A camera as KITTI's, scaled to `size`: f = 0.58 width, baseline 0.537 m, principal point near the middle.
StereoCamera street_camera(const cv::Size& size);

struct StreetFrame {
  RenderedView left, right;
  cv::Mat1b left_grey, right_grey;
  cv::Mat3b left_bgr, right_bgr;         // where SequenceSettings::colour
  std::vector<InstanceMasks> instances;  // of the left view; where SequenceSettings::annotations
};

class StreetSequence {
 public:
  // Throws UsageError for settings that make no sense, InputError for a bad pose file.
  explicit StreetSequence(const SequenceSettings& settings);
  StreetSequence(const StreetSequence&) = delete;  // the renderers refer to the world
  StreetSequence& operator=(const StreetSequence&) = delete;

  int size() const { return static_cast<int>(drive_.poses.size()); }
  const StereoCamera& camera() const { return camera_; }
  const Trajectory& poses() const { return drive_.poses; }  // T_wc in the street's frame (ground: y = 0)
  const World& world() const { return world_; }
  const SequenceSettings& settings() const { return settings_; }
  // Renders frame `i`; the images in `frame` are reused from call to call.
  void render(int i, StreetFrame& frame);

 private:
  SequenceSettings settings_;
  StereoCamera camera_;
  Drive drive_;
  World world_;
  RayCaster left_, right_;
};

// Writes the sequence below `folder`:
//   sequences/00/image_0, image_1 [, image_2, image_3]/NNNNNN.png    left, right; grey, then colour
//   sequences/00/calib.txt, times.txt
//   sequences/00/instances/NNNNNN.png   16 bits: instance ids of the left image, 0 = background
//   sequences/00/instances.json         per id: class and whether it moves
//   sequences/00/depth/NNNNNN.png       16 bits, 256 = 1 m, 0 = sky or beyond 255 m (where settings.depth)
//   annotations/instances.json          COCO, see coco_annotations.h (where settings.annotations)
//   poses/00.txt                        T_wc of the left camera, the first the identity
// `folder` must be missing or empty unless `overwrite`; then what an earlier run wrote there is removed
// first. `progress` is called after every frame with the number of frames done. Throws UsageError for a
// folder that is not empty, Error where writing fails.
void write_kitti_layout(StreetSequence& sequence, const std::filesystem::path& folder, bool overwrite,
                        const std::function<void(int)>& progress = {});

}  // namespace penumbra::slam::synthetic
