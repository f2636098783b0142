#include "slam/geometry/rectification.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "nn/base/error.h"
#include "slam/geometry/rectified_view.h"

namespace penumbra::slam {

namespace {

constexpr const char* kExpected = "lenses whose images can be made those of pinhole cameras";

// Smaller or larger images no remap can hold.
void check_size(const LensCamera& lens, const std::string& place) {
  constexpr int kLeast = 2, kMost = 32767;
  if (std::min(lens.width, lens.height) >= kLeast && std::max(lens.width, lens.height) <= kMost) return;
  throw InputError(place, fmt::format("images of {} x {} to {} x {} pixels", kLeast, kLeast, kMost, kMost),
                   fmt::format("{} x {}", lens.width, lens.height));
}

// Where the pinhole camera, turned from the lens by `turn`, has its pixels from.
Remap make_remap(const LensCamera& lens, const Eigen::Matrix3d& turn, const Pinhole& pinhole) {
  const Eigen::Matrix3d back = (pinhole.matrix() * turn).inverse();
  FloatImage x(lens.width, lens.height), y(lens.width, lens.height);
  constexpr double kNowhere = -std::numeric_limits<double>::infinity();  // behind the camera
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const Eigen::Vector3d ray = back * Eigen::Vector3d(u, v, 1.0);
      const Eigen::Vector2d place =
          ray.z() > 0.0 ? pixel_of(lens, ray.hnormalized()) : Eigen::Vector2d::Constant(kNowhere);
      x.at(u, v) = static_cast<float>(place.x());
      y.at(u, v) = static_cast<float>(place.y());
    }
  }
  return {x, y, {lens.width, lens.height}};
}

// The size is that of the real camera.
StereoCamera camera_of(const Pinhole& pinhole, const LensCamera& lens, const std::string& place) {
  StereoCamera camera;
  camera.fx = pinhole.fx;
  camera.fy = pinhole.fy;
  camera.cx = pinhole.cx;
  camera.cy = pinhole.cy;
  camera.width = lens.width;
  camera.height = lens.height;
  const bool possible = std::isfinite(camera.fx) && camera.fx > 0.0 && std::isfinite(camera.fy) &&
                        camera.fy > 0.0 && std::isfinite(camera.cx) && std::isfinite(camera.cy) &&
                        camera.fx < 100.0 * lens.fx;
  if (!possible) {
    throw InputError(place, kExpected,
                     fmt::format("fx {:g} fy {:g} cx {:g} cy {:g} after rectification", camera.fx, camera.fy,
                                 camera.cx, camera.cy));
  }
  return camera;
}

}  // namespace

StereoRectification rectify_stereo(const LensCamera& left, const LensCamera& right, const SE3& T_right_left,
                                   const std::string& place) {
  if (left.width != right.width || left.height != right.height) {
    throw InputError(place, fmt::format("two cameras of the same size, {} x {}", left.width, left.height),
                     fmt::format("{} x {}", right.width, right.height));
  }
  if (left.model != right.model) {
    throw InputError(place, "two cameras of the same distortion model", "different ones");
  }
  const Eigen::Vector3d b = T_right_left.inverse().translation;  // the right camera's centre
  if (!(b.x() > std::abs(b.y()) && b.x() > std::abs(b.z()))) {
    throw InputError(
        place, "a second camera to the right of the first (baseline along +x)",
        fmt::format("one at ({:.4g}, {:.4g}, {:.4g}) m: are they swapped?", b.x(), b.y(), b.z()));
  }
  check_size(left, place);
  const RectifyingTurns turns = rectifying_turns(T_right_left);
  const Pinhole view = rectified_view(left, right, turns);
  StereoRectification result;
  result.camera = camera_of(view, left, place);
  result.camera.baseline = b.norm();
  result.left = make_remap(left, turns.left, view);
  result.right = make_remap(right, turns.right, view);
  result.R_rectified_left = turns.left;
  return result;
}

Undistortion undistort(const LensCamera& camera, const std::string& place) {
  Undistortion result;
  if (camera.distortion.empty()) {
    result.camera = camera_of({camera.fx, camera.fy, camera.cx, camera.cy}, camera, place);
    return result;
  }
  check_size(camera, place);
  const Pinhole view = rectified_view(camera);
  result.camera = camera_of(view, camera, place);
  result.remap = make_remap(camera, Eigen::Matrix3d::Identity(), view);
  return result;
}

}  // namespace penumbra::slam
