#include "slam/brain/loaded_map.h"

#include <cmath>
#include <numbers>

#include "nn/base/error.h"
#include "slam/map/map_file.h"

namespace penumbra::slam::brain {

namespace {

std::string camera_text(double yaw, double pitch) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  return fmt::format("a camera turned by {:.0f} degrees to the left and {:.0f} down", yaw / kDegree,
                     pitch / kDegree);
}

}  // namespace

void require_fitting(const StoredMap& stored, const StereoCamera& camera, const BrainSettings& settings,
                     const std::string& place) {
  require_same_camera(stored.camera, camera, place);
  if (stored.templates != settings.templates) {
    throw InputError(place, fmt::format("templates of {}", to_string(settings.templates)),
                     to_string(stored.templates));
  }
  constexpr double kSameTurn = 0.05;  // radians
  const double yaw = settings.mount.yaw(), pitch = settings.mount.pitch();
  if (std::abs(wrapped_angle(stored.camera_yaw - yaw)) > kSameTurn ||
      std::abs(stored.camera_pitch - pitch) > kSameTurn) {
    throw InputError(place, camera_text(yaw, pitch), camera_text(stored.camera_yaw, stored.camera_pitch));
  }
}

}  // namespace penumbra::slam::brain
