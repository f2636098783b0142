// Where the camera drives: a route over the ground and the camera's pose at each frame.
//
// The street is flat: y = 0 is the ground and y points down, as in KITTI's camera frame; a route is a curve
// in (x, z). Heading h looks along (sin h, cos h); `right` of it is (cos h, -sin h).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "slam/geometry/trajectory.h"

namespace penumbra::slam::synthetic {

struct GroundPose {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // (x, z), metres
  double heading = 0.0;                                // radians
};

// A curve through points about a metre apart, addressed by arc length. Beyond its ends it goes on straight.
class Route {
 public:
  Route() = default;
  // At least two points, no two consecutive ones equal; `closed` joins the last to the first.
  explicit Route(std::vector<Eigen::Vector2d> points, bool closed = false);

  double length() const { return arc_.empty() ? 0.0 : arc_.back(); }
  bool closed() const { return closed_; }
  // Place at arc length `s`, `right` metres to the right of the curve; a closed route wraps round.
  GroundPose at(double s, double right = 0.0) const;
  const std::vector<Eigen::Vector2d>& points() const { return points_; }
  // Arc length of the point of the curve nearest to `position`, searched within `from`..`to`.
  double nearest_arc(const Eigen::Vector2d& position, double from, double to) const;

 private:
  std::vector<Eigen::Vector2d> points_;  // the first again at the end where closed
  std::vector<double> arc_;              // arc length at each point
  bool closed_ = false;
};

// Metres that the street goes on beyond both ends of an open route, so that its end is never in view.
constexpr double kRouteMargin = 150.0;
constexpr double kCameraHeight = 1.65;  // metres above the ground, as on KITTI's car
constexpr double kFrameRate = 10.0;     // frames per second, as in KITTI

struct Drive {
  Route route;              // the camera's track with margins at both ends where it is open
  Trajectory poses;         // T_wc in the street's frame, one per frame
  std::vector<double> arc;  // arc length on the route, one per frame
};

// Built-in drives at 0.8 m per frame (29 km/h): "straight"; "corner", a right turn half way; "block", once
// round four right-angle bends (284 frames); "eight", a figure of eight that crosses itself at a right angle
// (574 frames); both go round again where `frames` asks for more. Throws UsageError for another name.
Drive make_drive(const std::string& path_name, int frames);
// The drive of a KITTI pose file (12 numbers a line, a 3x4 T_wc, camera x right, y down, z forward), cut to
// its first `frames` poses (0 = all). Position in the plane and heading are kept; height, pitch and roll are
// replaced by those of a flat street, since the drive must fit a world without hills.
// Throws InputError for a file that is missing or not of that form, UsageError if it has fewer poses.
Drive load_drive(const std::filesystem::path& file, int frames);

// The camera above `ground`, with the small sway of a car: heave, pitch and roll as smooth functions of
// `arc`.
SE3 camera_pose(const GroundPose& ground, double arc);

}  // namespace penumbra::slam::synthetic
