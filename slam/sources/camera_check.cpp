#include "slam/sources/camera_check.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

namespace penumbra::slam {

namespace {

constexpr double kMiddleBegin = 0.25, kMiddleEnd = 0.75;     // of the image
constexpr double kNarrowest = 15.0, kWidest = 150.0;         // degrees
constexpr double kLeastRatio = 0.9, kMostRatio = 1.0 / 0.9;  // fx / fy

}  // namespace

std::vector<std::string> check_camera(const StereoCamera& camera, bool is_undone) {
  std::vector<std::string> found;
  const double x = camera.cx / camera.width, y = camera.cy / camera.height;
  const auto is_in_middle = [](double share) { return share >= kMiddleBegin && share <= kMiddleEnd; };
  if (!is_in_middle(x) || !is_in_middle(y)) {
    found.push_back(fmt::format(
        "the principal point ({:.1f}, {:.1f}) is far from the middle of images of {} x {} pixels. Is the "
        "calibration "
        "that of images of another size, or are the intrinsics in another order than fx, fy, cx, cy?",
        camera.cx, camera.cy, camera.width, camera.height));
  }
  const double field =
      (std::atan(camera.cx / camera.fx) + std::atan((camera.width - camera.cx) / camera.fx)) * 180.0 /
      std::numbers::pi;
  if (!(field >= kNarrowest && field <= kWidest)) {
    found.push_back(
        fmt::format("the horizontal field of view would be {:.1f} degrees: fx = {:.6g} in images of {} "
                    "pixels width. Is the "
                    "calibration that of images of another size, or the focal length in millimetres?",
                    field, camera.fx, camera.width));
  }
  const double ratio = camera.fx / camera.fy;
  if (!is_undone && !(ratio >= kLeastRatio && ratio <= kMostRatio)) {
    found.push_back(fmt::format(
        "pixels would not be square: fx = {:.6g}, fy = {:.6g}. Are the intrinsics in another order than "
        "fx, fy, cx, cy, or were the images stretched?",
        camera.fx, camera.fy));
  }
  return found;
}

}  // namespace penumbra::slam
