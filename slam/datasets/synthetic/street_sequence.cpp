#include "slam/datasets/synthetic/street_sequence.h"

#include <algorithm>

#include "nn/base/error.h"
#include "slam/datasets/synthetic/noise.h"

namespace penumbra::slam::synthetic {

namespace {

constexpr int kDefaultFrames = 60, kMaxFrames = 20000;
constexpr int kMinSide = 32, kMaxSide = 8192;  // pixels

SequenceSettings checked(SequenceSettings settings) {
  const auto fits = [](int side) { return side >= kMinSide && side <= kMaxSide; };
  if (!fits(settings.size.width) || !fits(settings.size.height)) {
    throw UsageError(fmt::format("--size: expected {0}x{0} to {1}x{1}, found {2}x{3}", kMinSide, kMaxSide,
                                 settings.size.width, settings.size.height));
  }
  if (settings.frames < 0 || settings.frames > kMaxFrames) {
    throw UsageError(fmt::format("--frames: expected 1 to {}, found {}", kMaxFrames, settings.frames));
  }
  return settings;
}

Drive drive_of(const SequenceSettings& settings) {
  // The built-in names have no dot and no slash, a file's path has one or the other.
  if (settings.path.find_first_of("./") != std::string::npos)
    return load_drive(settings.path, settings.frames);
  return make_drive(settings.path, settings.frames == 0 ? kDefaultFrames : settings.frames);
}

}  // namespace

StereoCamera street_camera(const cv::Size& size) {
  StereoCamera camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.fx = camera.fy = 0.58 * size.width;
  // KITTI's principal point: 0.489 of the width, 0.495 of the height.
  camera.cx = 0.489 * size.width;
  camera.cy = 0.495 * size.height;
  camera.baseline = 0.537;
  return camera;
}

StreetSequence::StreetSequence(const SequenceSettings& settings)
    : settings_(checked(settings)),
      camera_(street_camera(settings.size)),
      drive_(drive_of(settings_)),
      world_(build_street(drive_, street_preset(settings_.preset), settings_.seed)),
      left_(world_),
      right_(world_) {}

void StreetSequence::render(int i, StreetFrame& frame) {
  const TimedPose& pose = drive_.poses[static_cast<std::size_t>(i)];
  SE3 right = pose.T_wc;
  right.translation += camera_.baseline * pose.T_wc.rotation.col(0);
  left_.render(camera_, pose.T_wc, pose.timestamp, frame.left);
  right_.render(camera_, right, pose.timestamp, frame.right);

  if (settings_.annotations) frame.instances = find_instances(left_.geometry(), frame.left);

  const float exposure = automatic_exposure(frame.left.radiance, pose.timestamp, settings_.seed);
  std::uint32_t image = 0;
  const auto sensor = [&] {
    return SensorSettings{.exposure = exposure,
                          .noise_seed = hash_of(settings_.seed, static_cast<std::uint32_t>(i), image++)};
  };
  develop_grey(frame.left.radiance, sensor(), frame.left_grey);
  develop_grey(frame.right.radiance, sensor(), frame.right_grey);
  if (!settings_.colour) return;
  develop_bgr(frame.left.radiance, sensor(), frame.left_bgr);
  develop_bgr(frame.right.radiance, sensor(), frame.right_bgr);
}

}  // namespace penumbra::slam::synthetic
