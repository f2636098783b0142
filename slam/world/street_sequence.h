// A stereo drive through the synthetic street, frame by frame, and the writer of its KITTI layout.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "slam/world/camera_sensor.h"
#include "slam/world/ground_truth_images.h"
#include "slam/world/instance_masks.h"
#include "slam/world/ray_caster.h"
#include "slam/world/street_builder.h"

namespace penumbra::slam::synthetic {

enum class Sensor { stereo, rgbd };

struct SequenceSettings {
  StreetSettings street = {};
  Sensor sensor = Sensor::stereo;
  std::string path = "block";  // "block", "eight", "straight" or a KITTI pose file
  int frames = 0;              // 0: 60, or all of a pose file
  Size size{620, 188};         // pixels
  std::uint32_t seed = 1;
  bool annotations = false;  // COCO instances of the left or only image
  // What stereo drives have beyond grey pairs and instance ids; all but `colour` for the left image.
  bool colour = false;
  bool depth = false, disparity = false, flow = false;
  bool amodal = false;  // the objects' whole masks as images
};

// A camera as KITTI's, scaled to `size`: f = 0.58 width, baseline 0.537 m, principal point near the middle.
StereoCamera street_camera(const Size& size);

struct StreetFrame {
  RenderedView left, right;
  ByteImage left_grey, right_grey;
  ByteImage left_bgr, right_bgr;         // where SequenceSettings::colour
  std::vector<InstanceMasks> instances;  // of the left view; where SequenceSettings::annotations or amodal
  FlowImage flow;           // see optical_flow; where SequenceSettings::flow, none in the last frame
  FloatImage sensed_depth;  // of Sensor::rgbd, which has left_bgr but neither grey nor right images
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
  SE3 pose_at_time(double time) const;
  void blur(int i, StreetFrame& frame);
  void add_stray_light(int i, StreetFrame& frame) const;

  SequenceSettings settings_;
  StereoCamera camera_;
  Drive drive_;
  World world_;
  RayCaster left_, right_;
  RenderedView blurred_;  // scratch
};

// Writes the sequence below `folder`:
//   sequences/00/image_0, image_1 [, image_2, image_3]/NNNNNN.png    left, right; grey, then colour
//   sequences/00/calib.txt, times.txt, name.txt (what to call it in logs and reports)
//   sequences/00/instances/NNNNNN.png   16 bits: instance ids of the left image, 0 = background
//   sequences/00/instances.json         per id: class and whether it moves
//   sequences/00/depth/NNNNNN.png       16 bits, 256 = 1 m, 0 = sky or beyond 255 m (where settings.depth)
//   sequences/00/disparity/NNNNNN.png   16 bits, 256 = 1 pixel, 0 = sky (where settings.disparity)
//   sequences/00/flow/NNNNNN.png        3 x 16 bits as KITTI's flow, to the next frame (where settings.flow)
//   sequences/00/amodal/NNNNNN/IIIII.png  8 bits: 255 on the whole of instance IIIII (where settings.amodal)
//   annotations/instances.json          COCO, see coco_annotations.h (where settings.annotations)
//   poses/00.txt                        T_wc of the left camera, the first the identity
// `folder` must be missing or empty unless `overwrite`; then what an earlier run wrote there is removed
// first. `progress` is called after every frame with the number of frames done. Throws UsageError for a
// folder that is not empty, Error where writing fails.
void write_kitti_layout(StreetSequence& sequence, const std::filesystem::path& folder, bool overwrite,
                        const std::function<void(int)>& progress = {});

// Writes an RGB-D drive as TUM lays its own out:
//   rgb/T.png, depth/T.png       colour; 16 bits, 5000 = 1 m, 0 = no depth (see depth_sensor.h); T in seconds
//   rgb.txt, depth.txt           "T folder/T.png" a line
//   groundtruth.txt              T tx ty tz qx qy qz qw: T_wc of the optical frame, the first the identity
//   calibration.yaml             width, height, fx, fy, cx, cy, depth_factor, rate
//   instances/T.png, instances.json  as above
// `folder` and errors as above.
void write_tum_layout(StreetSequence& sequence, const std::filesystem::path& folder, bool overwrite,
                      const std::function<void(int)>& progress = {});

}  // namespace penumbra::slam::synthetic
