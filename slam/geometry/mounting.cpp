#include "slam/geometry/mounting.h"

#include <fmt/core.h>

#include <algorithm>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::slam {

SE3 pose_of_body(const Mounting& body, const SE3& T_wc) {
  return body.T_frame_camera * T_wc * body.T_frame_camera.inverse();
}

Trajectory poses_of_body(const Mounting& body, Trajectory poses) {
  for (TimedPose& pose : poses) pose.T_wc = pose_of_body(body, pose.T_wc);
  return poses;
}

const Mounting& mounting_of(const std::string& frame, const std::vector<Mounting>& mountings,
                            const std::string& place) {
  const std::string name = frame.substr(frame.starts_with('/') ? 1 : 0);
  const auto found =
      std::find_if(mountings.begin(), mountings.end(), [&](const Mounting& m) { return m.frame == name; });
  if (found != mountings.end()) return *found;
  if (mountings.empty()) {
    throw InputError(
        place,
        "where the camera stands on its body (/tf_static of a recording, or a calibration with T_BS, "
        "T_cam_imu, T_imu_cam or T_body_left)",
        "nothing of it");
  }
  std::string names;
  constexpr std::size_t kShown = 30;
  for (std::size_t i = 0; i < std::min(kShown, mountings.size()); ++i)
    names += fmt::format("{}{}", i == 0 ? "" : ", ", printable(mountings[i].frame, 60));
  if (mountings.size() > kShown) names += fmt::format(" and {} more", mountings.size() - kShown);
  throw InputError(place, fmt::format("a frame in which the left camera stands still: {}", names),
                   fmt::format("'{}'", printable(frame, 60)));
}

}  // namespace penumbra::slam
