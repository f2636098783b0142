#include "apps/library/rig.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "nn/base/error.h"

namespace penumbra {

namespace {

// The rest is checked by slam::Slam.
std::shared_ptr<Rig::Parts> parts_of(const Pinhole& camera, double baseline) {
  auto parts = std::make_shared<Rig::Parts>();
  parts->cameras.camera = {.fx = camera.fx,
                           .fy = camera.fy,
                           .cx = camera.cx,
                           .cy = camera.cy,
                           .baseline = baseline,
                           .width = camera.width,
                           .height = camera.height};
  parts->width = camera.width;
  parts->height = camera.height;
  return parts;
}

}  // namespace

Rig::Rig(std::shared_ptr<const Parts> parts) : parts_(std::move(parts)) {}

Rig Rig::stereo(const Pinhole& camera, double baseline) { return Rig(parts_of(camera, baseline)); }

Rig Rig::rgbd(const Pinhole& camera, double depth_factor) {
  if (!(std::isfinite(depth_factor) && depth_factor > 0.0))
    throw InputError("rig with depth", "units a metre above zero", fmt::format("{}", depth_factor));
  const std::shared_ptr<Parts> parts = parts_of(camera, slam::kNominalBaseline);
  parts->sensor = slam::Sensor::rgbd;
  parts->depth_factor = depth_factor;
  return Rig(parts);
}

Rig Rig::read(const std::string& path) {
  const slam::CameraFile file = slam::read_camera_file(path);
  if (file.left.width == 0)
    throw InputError(path, "the images' size (width, height): no image is there to tell it", "none");
  auto parts = std::make_shared<Parts>();
  parts->sensor = file.sensor;
  parts->cameras = slam::make_camera(file);
  parts->width = file.left.width;
  parts->height = file.left.height;
  parts->depth_factor = file.depth_factor;
  return Rig(parts);
}

bool Rig::has_depth() const { return parts_->sensor == slam::Sensor::rgbd; }

Pinhole Rig::camera() const {
  const slam::StereoCamera& c = parts_->cameras.camera;
  return {c.fx, c.fy, c.cx, c.cy, c.width, c.height};
}

double Rig::baseline() const { return parts_->cameras.camera.baseline; }

int Rig::raw_width() const { return parts_->width; }

int Rig::raw_height() const { return parts_->height; }

}  // namespace penumbra
