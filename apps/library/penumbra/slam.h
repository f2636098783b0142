// Visual SLAM for a program: images go in, poses and a map come out.
//
//   penumbra::Slam slam(penumbra::Rig::read("calibration.yaml"));
//   while (...) {
//     penumbra::TrackResult found = slam.track({.timestamp = t, .left = left, .right = right});
//     if (found.state == penumbra::State::tracking) steer_by(found.T_world_camera);
//   }
//
// Units: metres, seconds, radians, pixels. Frames of reference: the camera's is x right, y down, z ahead, of
// the left (or only) camera, rectified; the world's is that of the first frame, or of the map that was
// loaded.
//
// Threads. One thread at a time calls a Slam's functions, and on_map_changed's function is called on that
// thread, from within track() or finish(). snapshot() alone may be called from any thread at any time. Slam
// has threads of its own for mapping, for adjusting the whole map and for the network; none of them calls the
// user's code. Two Slams do not know of each other.
//
// Errors are std::runtime_error, whose text says where, what was expected and what was found. An error of
// track() leaves the Slam as it was: the next frame may be given.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "penumbra/export.h"
#include "penumbra/image.h"
#include "penumbra/pose.h"

namespace penumbra {

// A pinhole camera without distortion: u = fx X/Z + cx, v = fy Y/Z + cy; pixel centres are whole numbers.
struct Pinhole {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  // pixels
  int width = 0, height = 0;
};

// The cameras: two side by side, or one with depth.
class PENUMBRA_API Rig {
 public:
  // Rectified pairs: rows correspond, both images are those of `camera`, the right one `baseline` metres to
  // the right.
  static Rig stereo(const Pinhole& camera, double baseline);
  // Images with the depth of each pixel, rectified. `depth_factor`: units of 16-bit depth a metre (1000:
  // millimetres).
  static Rig rgbd(const Pinhole& camera, double depth_factor = 1000.0);
  // A calibration.yaml (docs/datasets.md), also of raw images: track() then rectifies them.
  static Rig read(const std::string& path);

  bool has_depth() const;
  Pinhole camera() const;   // of the rectified left image
  double baseline() const;  // metres; nominal where there is depth
  // Size of the images that track() wants.
  int raw_width() const;
  int raw_height() const;

  struct Parts;

 private:
  friend class Slam;
  explicit Rig(std::shared_ptr<const Parts> parts);
  std::shared_ptr<const Parts> parts_;
};

struct SlamOptions {
  std::string settings = {};  // a JSON file (`penumbra slam --print-settings`); empty: defaults
  int threads = 0;            // of tracking, features and adjustments; 0: as many as there are processors
  // Everything in the calling thread, bit for bit the same every time; slower.
  bool deterministic = false;
  std::string weights = {};  // of the network that finds what may move; empty: geometry alone
  // How masks are made of what the network finds: "masks" (its own), and with depth "boxes",
  // "depth-clusters", "static-points". Empty: as the settings say, "masks" by default.
  std::string dynamics = {};
  std::string map = {};   // to begin with; empty: a new one
  bool localise = false;  // only find the way in that map
  // Keeps each frame's place for trajectory(), some 100 bytes a frame.
  bool keeps_trajectory = true;
};

struct Frame {
  double timestamp = 0.0;  // seconds; later than the frame before
  ImageRef left = {};      // grey or colour
  ImageRef right = {};     // of a stereo rig
  ImageRef depth = {};     // of a rig with depth: registered to `left`, of its size
  // What wheels or an inertial sensor say of the camera's motion since the frame before, T_now_before: the
  // images are compared from there. Not needed.
  std::optional<Pose> motion = std::nullopt;
};

// `initialising`: nothing was seen yet that a map could begin with. `occluded`: what moves hides the view,
// and the pose is the expected one. `lost`: the pose is the expected one, and the place is looked for in the
// whole map.
enum class State { initialising, tracking, lost, occluded };

struct TrackResult {
  int frame = 0;           // counted from 0
  double timestamp = 0.0;  // seconds
  State state = State::initialising;
  Pose T_world_camera = {};  // in the map as it is when track() returns
  // Of a small motion of the camera in its own frame (metres along x, y, z, radians about them), row by row,
  // as if map points were known exactly. Empty unless tracking in the map.
  std::optional<std::array<double, 36>> covariance = std::nullopt;
  int inliers = 0;            // map points that agree with the pose
  bool keyframe = false;      // it became part of the map
  bool recovered = false;     // lost before, found again
  bool new_piece = false;     // a piece of map begins here that is not tied to the earlier one
  std::string why_lost = {};  // unless tracking: what is probably the matter
  // What is probably wrong with the rig, the times or the images; each is told once.
  std::vector<std::string> warnings = {};
};

struct MapPoint {
  std::array<float, 3> position{};       // world, metres
  std::array<std::uint8_t, 3> colour{};  // red, green, blue
};

struct MapSnapshot {
  std::vector<TimedPose> keyframes = {};
  std::vector<MapPoint> points = {};  // without those whose place is mostly uncertain
  int loops = 0;                      // that were closed so far
};

class PENUMBRA_API Slam {
 public:
  explicit Slam(Rig rig, SlamOptions options = {});
  ~Slam();
  Slam(Slam&&) noexcept;
  Slam& operator=(Slam&&) noexcept;

  TrackResult track(const Frame& frame);
  // Called when the map was moved where the camera is, by more than a centimetre or a tenth of a degree, as a
  // closed loop moves it: T_new_old, by which what was placed near the camera is to be moved, too.
  void on_map_changed(std::function<void(const Pose& T_new_old)> told);
  MapSnapshot snapshot() const;
  // Of each frame so far, as the map now has it; empty unless keeps_trajectory.
  std::vector<TimedPose> trajectory() const;
  // Waits until every frame is mapped, every loop closed.
  void finish();
  // finish(), and the map into a file that SlamOptions::map takes; an older file is replaced whole or not at
  // all.
  void save_map(const std::string& path);
  // Forgets map and frames, as after the constructor. The network stays loaded.
  void reset();

 private:
  class Run;
  std::unique_ptr<Run> run_;
};

}  // namespace penumbra
