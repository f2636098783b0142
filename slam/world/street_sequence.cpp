#include "slam/world/street_sequence.h"

#include <algorithm>
#include <cmath>

#include "nn/base/error.h"
#include "slam/world/depth_sensor.h"
#include "slam/world/ground_truth_images.h"
#include "slam/world/noise.h"

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
  settings.street.check();
  if (settings.sensor == Sensor::rgbd &&
      (settings.colour || settings.depth || settings.disparity || settings.flow || settings.amodal)) {
    throw UsageError(
        "--sensor rgbd writes colour and depth; --colour, --depth, --disparity, --flow and --amodal are for "
        "stereo drives");
  }
  return settings;
}

Drive drive_of(const SequenceSettings& settings) {
  // The built-in names have no dot and no slash, a file's path has one or the other.
  if (settings.path.find_first_of("./") != std::string::npos)
    return load_drive(settings.path, settings.frames);
  return make_drive(settings.path, settings.frames == 0 ? kDefaultFrames : settings.frames);
}

// sum += share * light, of images of the same size.
void add_share(const Image<Colour>& light, float share, Image<Colour>& sum) {
  for (std::size_t i = 0; i < sum.elements(); ++i) sum.data()[i] += share * light.data()[i];
}

SE3 right_of(SE3 T_wc, const StereoCamera& camera) {
  T_wc.translation += camera.baseline * T_wc.rotation.col(0);
  return T_wc;
}

}  // namespace

StereoCamera street_camera(const Size& size) {
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
      world_(build_street(drive_, settings_.street, settings_.seed)),
      left_(world_),
      right_(world_) {}

SE3 StreetSequence::pose_at_time(double time) const {
  const Trajectory& poses = drive_.poses;
  if (poses.size() < 2) return poses.front().T_wc;
  const int frame = static_cast<int>(std::floor(time * kFrameRate));
  const auto i = static_cast<std::size_t>(std::clamp(frame, 0, static_cast<int>(poses.size()) - 2));
  const SE3 step = poses[i].T_wc.inverse() * poses[i + 1].T_wc;
  const double share = time * kFrameRate - static_cast<double>(i);
  return poses[i].T_wc * SE3::exp(share * step.log());
}

// Replaces the light of both views by its mean over the time that the shutter is open; the frame's own time
// is in the middle.
void StreetSequence::blur(int i, StreetFrame& frame) {
  constexpr int kSamples = 6;
  const double time = drive_.poses[static_cast<std::size_t>(i)].timestamp;
  frame.left.radiance.fill(Colour::Zero());
  if (settings_.sensor == Sensor::stereo) frame.right.radiance.fill(Colour::Zero());
  for (int k = 0; k < kSamples; ++k) {
    const double at = time + static_cast<double>(settings_.street.shutter) * ((k + 0.5) / kSamples - 0.5);
    const SE3 T_wc = pose_at_time(at);
    left_.render(camera_, T_wc, at, blurred_);
    add_share(blurred_.radiance, 1.0F / kSamples, frame.left.radiance);
    if (settings_.sensor == Sensor::rgbd) continue;
    right_.render(camera_, right_of(T_wc, camera_), at, blurred_);
    add_share(blurred_.radiance, 1.0F / kSamples, frame.right.radiance);
  }
}

void StreetSequence::add_stray_light(int i, StreetFrame& frame) const {
  const SE3& T_wc = drive_.poses[static_cast<std::size_t>(i)].T_wc;
  const Eigen::Vector3f to_sun = T_wc.rotation.transpose().cast<float>() * world_.to_sun;
  const auto seed = [&](std::uint32_t camera) {
    return hash_of(settings_.seed, static_cast<std::uint32_t>(i), 0x61a4eU + camera);
  };
  add_glare(frame.left.radiance, camera_, to_sun, world_.sun_colour, settings_.street.glare, seed(0));
  if (settings_.sensor == Sensor::rgbd) return;
  add_glare(frame.right.radiance, camera_, to_sun, world_.sun_colour, settings_.street.glare, seed(1));
}

void StreetSequence::render(int i, StreetFrame& frame) {
  const TimedPose& pose = drive_.poses[static_cast<std::size_t>(i)];
  const bool stereo = settings_.sensor == Sensor::stereo;
  frame.left.wants_reflectance = !stereo;
  left_.render(camera_, pose.T_wc, pose.timestamp, frame.left);
  if (stereo) right_.render(camera_, right_of(pose.T_wc, camera_), pose.timestamp, frame.right);

  // Ground truth is that of the middle of the exposure; only light is blurred.
  if (settings_.annotations || settings_.amodal) {
    frame.instances = find_instances(left_.geometry(), frame.left);
  }
  if (settings_.flow && i + 1 < size()) {
    frame.flow =
        optical_flow(world_, camera_, frame.left, pose, drive_.poses[static_cast<std::size_t>(i) + 1]);
  }
  if (settings_.street.shutter > 0.0F) blur(i, frame);
  if (settings_.street.glare > 0.0F) add_stray_light(i, frame);

  const float exposure = automatic_exposure(frame.left.radiance, pose.timestamp,
                                            settings_.street.exposure_change, settings_.seed);
  std::uint32_t image = 0;
  const auto sensor = [&] {
    return SensorSettings{.exposure = exposure,
                          .noise = settings_.street.noise,
                          .noise_seed = hash_of(settings_.seed, static_cast<std::uint32_t>(i), image++)};
  };
  if (!stereo) {
    develop_bgr(frame.left.radiance, sensor(), frame.left_bgr);
    sense_depth(frame.left, camera_, sensor().noise_seed, frame.sensed_depth);
    return;
  }
  develop_grey(frame.left.radiance, sensor(), frame.left_grey);
  develop_grey(frame.right.radiance, sensor(), frame.right_grey);
  if (!settings_.colour) return;
  develop_bgr(frame.left.radiance, sensor(), frame.left_bgr);
  develop_bgr(frame.right.radiance, sensor(), frame.right_bgr);
}

}  // namespace penumbra::slam::synthetic
