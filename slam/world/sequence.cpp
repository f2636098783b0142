#include "slam/world/sequence.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "nn/base/ceil_div.h"
#include "nn/base/error.h"
#include "slam/world/depth_sensor.h"
#include "slam/world/noise.h"

namespace penumbra::slam::synthetic {

namespace {

// sum += share * light, of images of the same size.
void add_share(const Image<Colour>& light, float share, Image<Colour>& sum) {
  for (std::size_t i = 0; i < sum.elements(); ++i) sum.data()[i] += share * light.data()[i];
}

SE3 right_camera_of(SE3 T_wc, const StereoCamera& camera) {
  T_wc.translation += camera.baseline * T_wc.rotation.col(0);
  return T_wc;
}

constexpr int kMaxFrames = 20000;
constexpr int kMinSide = 32, kMaxSide = 8192;  // pixels

}  // namespace

void check_extent(const Size& size, int frames) {
  const auto fits = [](int side) { return side >= kMinSide && side <= kMaxSide; };
  if (!fits(size.width) || !fits(size.height)) {
    throw UsageError(fmt::format("--size: expected {0}x{0} to {1}x{1}, found {2}x{3}", kMinSide, kMaxSide,
                                 size.width, size.height));
  }
  if (frames < 0 || frames > kMaxFrames) {
    throw UsageError(fmt::format("--frames: expected 1 to {}, found {}", kMaxFrames, frames));
  }
}

Sequence::Sequence(Scene scene, const Recording& recording)
    : scene_(std::move(scene)), recording_(recording), left_(scene_.world), right_(scene_.world) {
  if (recording_.depth_camera) depth_camera_.emplace(*recording_.depth_camera, recording_.seed);
}

SE3 Sequence::pose_at_time(double time) const {
  const Trajectory& poses = scene_.poses;
  if (poses.size() < 2) return poses.front().T_wc;
  const int frame = static_cast<int>(std::floor(time * scene_.rate));
  const auto i = static_cast<std::size_t>(std::clamp(frame, 0, static_cast<int>(poses.size()) - 2));
  const SE3 step = poses[i].T_wc.inverse() * poses[i + 1].T_wc;
  const double share = time * scene_.rate - static_cast<double>(i);
  return poses[i].T_wc * SE3::exp(share * step.log());
}

// Adds `share` of the light at `time` of a camera `to_right` metres to the right of the left one; of every
// band of rows at the time that the shutter opens for it.
void Sequence::add_light(RayCaster& caster, double time, double to_right, float share, Image<Colour>& light) {
  const auto pose_at = [&](double at) {
    SE3 T_wc = pose_at_time(at);
    T_wc.translation += to_right * T_wc.rotation.col(0);
    return T_wc;
  };
  if (recording_.readout <= 0.0F) {
    caster.render(scene_.camera, pose_at(time), time, blurred_);
  } else {
    const int bands = ceil_div(scene_.camera.height, kTileHeight);
    for (int band = 0; band < bands; ++band) {
      const double at = time + static_cast<double>(recording_.readout) * ((band + 0.5) / bands - 0.5);
      caster.render_band(scene_.camera, pose_at(at), at, band, blurred_);
    }
  }
  add_share(blurred_.radiance, share, light);
}

// Replaces the light of both views by its mean over the time that the shutter is open; the frame's own time
// is in the middle, for the row in the middle.
void Sequence::expose(int i, SequenceFrame& frame) {
  const int samples = recording_.shutter > 0.0F ? 6 : 1;
  const float share = 1.0F / static_cast<float>(samples);
  const double time = scene_.poses[static_cast<std::size_t>(i)].timestamp;
  frame.left.radiance.fill(Colour::Zero());
  if (recording_.sensor == Sensor::stereo) frame.right.radiance.fill(Colour::Zero());
  for (int k = 0; k < samples; ++k) {
    const double at = time + static_cast<double>(recording_.shutter) * ((k + 0.5) / samples - 0.5);
    add_light(left_, at, 0.0, share, frame.left.radiance);
    if (recording_.sensor == Sensor::stereo)
      add_light(right_, at, scene_.camera.baseline, share, frame.right.radiance);
  }
}

void Sequence::add_stray_light(int i, SequenceFrame& frame) const {
  const SE3& T_wc = scene_.poses[static_cast<std::size_t>(i)].T_wc;
  const World& world = scene_.world;
  const Eigen::Vector3f to_sun = T_wc.rotation.transpose().cast<float>() * world.to_sun;
  const auto seed = [&](std::uint32_t camera) {
    return hash_of(recording_.seed, static_cast<std::uint32_t>(i), 0x61a4eU + camera);
  };
  add_glare(frame.left.radiance, scene_.camera, to_sun, world.sun_colour, recording_.glare, seed(0));
  if (recording_.sensor == Sensor::rgbd) return;
  add_glare(frame.right.radiance, scene_.camera, to_sun, world.sun_colour, recording_.glare, seed(1));
}

void Sequence::render(int i, SequenceFrame& frame) {
  const TimedPose& pose = scene_.poses[static_cast<std::size_t>(i)];
  const StereoCamera& camera = scene_.camera;
  const bool stereo = recording_.sensor == Sensor::stereo;
  frame.left.wants_reflectance = !stereo && !depth_camera_;
  frame.left.wants_objects = recording_.flow || recording_.landmarks;
  left_.render(camera, pose.T_wc, pose.timestamp, frame.left);
  if (stereo) right_.render(camera, right_camera_of(pose.T_wc, camera), pose.timestamp, frame.right);

  // Ground truth is that of the middle of the exposure; only light is blurred.
  if (recording_.annotations || recording_.amodal) {
    frame.instances = find_instances(left_.geometry(), frame.left);
  }
  if (recording_.flow && i + 1 < size()) {
    frame.flow =
        optical_flow(scene_.world, camera, frame.left, pose, scene_.poses[static_cast<std::size_t>(i) + 1]);
  }
  if (recording_.shutter > 0.0F || recording_.readout > 0.0F) expose(i, frame);
  if (recording_.glare > 0.0F) add_stray_light(i, frame);

  const float exposure =
      automatic_exposure(frame.left.radiance, pose.timestamp, recording_.exposure_change, recording_.seed);
  std::uint32_t image = 0;
  const auto sensor = [&] {
    return SensorSettings{.exposure = exposure,
                          .noise = recording_.noise,
                          .noise_seed = hash_of(recording_.seed, static_cast<std::uint32_t>(i), image++)};
  };
  if (!stereo) {
    develop_bgr(frame.left.radiance, sensor(), frame.left_bgr);
    const bool at_once = recording_.depth_delay == 0.0F;
    if (!at_once) {
      const double time = pose.timestamp + static_cast<double>(recording_.depth_delay);
      frame.right.wants_reflectance = frame.left.wants_reflectance;
      right_.render(camera, pose_at_time(time), time, frame.right);
      develop_bgr(frame.right.radiance, sensor(), frame.right_bgr);
    }
    const RenderedView& view = at_once ? frame.left : frame.right;
    if (depth_camera_) {
      depth_camera_->sense(view.depth, at_once ? frame.left_bgr : frame.right_bgr, i, frame.sensed_depth);
    } else {
      sense_depth(view, camera, sensor().noise_seed, frame.sensed_depth);
    }
    return;
  }
  develop_grey(frame.left.radiance, sensor(), frame.left_grey);
  develop_grey(frame.right.radiance, sensor(), frame.right_grey);
  if (!recording_.colour) return;
  develop_bgr(frame.left.radiance, sensor(), frame.left_bgr);
  develop_bgr(frame.right.radiance, sensor(), frame.right_bgr);
}

}  // namespace penumbra::slam::synthetic
