// A camera's way through a synthetic world, frame by frame: what the writers of layouts write.
//
// A scene is data: a world, a camera and its poses. street_sequence.h and office_sequence.h make scenes; how
// a frame comes of one is the same for all of them.
#pragma once

#include <optional>
#include <string>

#include "slam/world/camera_sensor.h"
#include "slam/world/depth_camera.h"
#include "slam/world/ground_truth_images.h"
#include "slam/world/instance_masks.h"
#include "slam/world/ray_caster.h"

namespace penumbra::slam::synthetic {

enum class Sensor { stereo, rgbd };

struct Scene {
  World world;
  StereoCamera camera;
  Trajectory poses;  // T_wc, one per frame, `rate` frames a second
  double rate = kFrameRate;
  std::string name;  // what logs and reports call it, such as "synthetic street, block, seed 1"
};

// What is kept of every frame, and how the camera takes it.
struct Recording {
  Sensor sensor = Sensor::stereo;
  std::uint32_t seed = 1;    // of the image noise
  bool annotations = false;  // COCO instances of the left or only image
  // What stereo drives have beyond grey pairs and instance ids; all but `colour` for the left image. RGB-D
  // always has colour; its `depth` is the clean one beside what the sensor saw; it has no disparity.
  bool colour = false;
  bool depth = false, disparity = false, flow = false;
  bool amodal = false;     // the objects' whole masks as images
  bool landmarks = false;  // which thing each pixel of the left or only image shows, see landmark_images.h

  float exposure_change = 0.1F;  // the exposure hunts by about this share around the automatic one
  float noise = 1.3F;            // sigma, grey levels
  float shutter = 0.0F;          // seconds that the shutter is open; 0: no motion blur
  float readout = 0.0F;      // seconds from the first row's exposure to the last one's; 0: all rows at once
  float depth_delay = 0.0F;  // seconds from the image to the depth, of Sensor::rgbd
  float glare = 0.0F;        // share of the light of sun and sky that strays over the image
  std::optional<DepthCameraSettings>
      depth_camera;  // of Sensor::rgbd; empty: the simple one of depth_sensor.h
};

struct SequenceFrame {
  RenderedView left, right;
  ByteImage left_grey, right_grey;
  ByteImage left_bgr, right_bgr;         // where Recording::colour
  std::vector<InstanceMasks> instances;  // of the left view; where Recording::annotations or amodal
  FlowImage flow;                        // see optical_flow; where Recording::flow, none in the last frame
  FloatImage sensed_depth;  // of Sensor::rgbd, which has left_bgr but neither grey nor right images
};

// Throws UsageError, naming the option, for sizes and numbers of frames (0 = as the scene has) out of range.
void check_extent(const Size& size, int frames);

class Sequence {
 public:
  Sequence(Scene scene, const Recording& recording);
  Sequence(const Sequence&) = delete;  // the renderers refer to the world
  Sequence& operator=(const Sequence&) = delete;

  int size() const { return static_cast<int>(scene_.poses.size()); }
  const StereoCamera& camera() const { return scene_.camera; }
  Size image_size() const { return {scene_.camera.width, scene_.camera.height}; }
  const Trajectory& poses() const { return scene_.poses; }  // T_wc in the world's frame
  const World& world() const { return scene_.world; }
  double rate() const { return scene_.rate; }  // frames a second
  const std::string& name() const { return scene_.name; }
  const Recording& recording() const { return recording_; }
  // Renders frame `i`; the images in `frame` are reused from call to call.
  void render(int i, SequenceFrame& frame);

 private:
  SE3 pose_at_time(double time) const;
  void expose(int i, SequenceFrame& frame);
  void add_light(RayCaster& caster, double time, double to_right, float share, Image<Colour>& light);
  void add_stray_light(int i, SequenceFrame& frame) const;

  Scene scene_;
  Recording recording_;
  RayCaster left_, right_;
  std::optional<DepthCamera> depth_camera_;
  RenderedView blurred_;  // scratch
};

}  // namespace penumbra::slam::synthetic
