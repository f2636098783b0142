// penumbra calibration: what a calibration file says about the cameras, and the same in our own keys.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/image_size.h"
#include "apps/common/log.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/sources/calibration/calibration.h"
#include "slam/sources/calibration/lens_reader.h"
#include "slam/sources/camera_check.h"

namespace penumbra::apps {

namespace {

struct CalibrationOptions {
  std::vector<std::filesystem::path> files;
  std::string size, output;
};

constexpr double kDegrees = 180.0 / std::numbers::pi;

double angle_between(const slam::LensCamera& lens, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector3d p = slam::direction_of(lens, a).homogeneous().normalized(),
                        q = slam::direction_of(lens, b).homogeneous().normalized();
  return std::acos(std::clamp(p.dot(q), -1.0, 1.0)) * kDegrees;
}

// Between the middles of opposite sides of the image.
std::string field_of_view(const slam::LensCamera& lens) {
  if (lens.width == 0) return "";
  const double w = lens.width - 1.0, h = lens.height - 1.0;
  return fmt::format(", field of view {:.1f} x {:.1f} degrees", angle_between(lens, {0.0, h / 2}, {w, h / 2}),
                     angle_between(lens, {w / 2, 0.0}, {w / 2, h}));
}

void print_lens(const char* name, const slam::LensCamera& lens) {
  fmt::print(
      "{:<10} fx {:.6g}, fy {:.6g}, cx {:.6g}, cy {:.6g} pixels, {}{}\n", name, lens.fx, lens.fy, lens.cx,
      lens.cy,
      lens.distortion.empty() ? "no distortion" : slam::lens_model_name(lens.model, lens.distortion.size()),
      field_of_view(lens));
}

void print_rig(const slam::CameraFile& camera) {
  if (camera.rectified) {
    print_lens("camera", camera.left);
    fmt::print("{:<10} {:.6g} m\n", "baseline", camera.baseline);
    if (camera.sensor == slam::Sensor::rgbd)
      fmt::print("{:<10} {:.6g} levels a metre\n", "depth", camera.depth_factor);
    return;
  }
  print_lens("left", camera.left);
  print_lens("right", camera.right);
  const Eigen::Vector3d base = camera.T_right_left.inverse().translation;
  fmt::print("{:<10} {:.6g} m: the right camera is at ({:.4f}, {:.4f}, {:.4f}) of the left one\n", "baseline",
             base.norm(), base.x(), base.y(), base.z());
  fmt::print("{:<10} {:.4f} degrees between the cameras\n", "rotation",
             Eigen::AngleAxisd(camera.T_right_left.rotation).angle() * kDegrees);
}

// A camera's own numbers: what undoes its lens may well stretch the image.
slam::StereoCamera as_given(const slam::LensCamera& lens) {
  slam::StereoCamera camera;
  camera.fx = lens.fx;
  camera.fy = lens.fy;
  camera.cx = lens.cx;
  camera.cy = lens.cy;
  camera.width = lens.width;
  camera.height = lens.height;
  return camera;
}

void calibration(const CalibrationOptions& options) {
  slam::Calibration read = slam::read_calibration(options.files);
  slam::CameraFile& camera = read.camera;
  if (!options.size.empty()) {
    const std::optional<Size> size = parse_image_size(options.size);
    if (!size) throw UsageError(fmt::format("--size: expected WIDTHxHEIGHT, found '{}'", options.size));
    const Size said{camera.left.width, camera.left.height};
    if (said.width > 0 && *size != said) {
      throw UsageError(fmt::format(
          "--size {}: the file is for images of {}x{} pixels, and its numbers are no other size's",
          options.size, said.width, said.height));
    }
    camera.left.width = camera.right.width = size->width;
    camera.left.height = camera.right.height = size->height;
  }
  const bool has_size = camera.left.width > 0;
  fmt::print("{:<10} {}: {}{}\n", "written by", read.dialect,
             camera.sensor == slam::Sensor::rgbd ? "a camera with depth"
             : camera.rectified                  ? "a rectified stereo pair"
                                                 : "two raw cameras",
             has_size ? fmt::format(" of {} x {} pixels", camera.left.width, camera.left.height) : "");
  print_rig(camera);
  for (const slam::Mounting& body : camera.mountings) {
    const Eigen::Vector3d& t = body.T_frame_camera.translation;
    fmt::print("{:<10} {}: the left camera is at ({:.4f}, {:.4f}, {:.4f}) of it\n", "body", body.frame, t.x(),
               t.y(), t.z());
  }
  for (const std::string& note : camera.notes) log_warning("{}", note);
  if (has_size) {
    const slam::RecordedCamera made = slam::make_camera(camera);
    const slam::StereoCamera& c = made.camera;
    if (!camera.rectified || !camera.left.distortion.empty()) {
      fmt::print("{:<10} fx {:.6g}, fy {:.6g}, cx {:.6g}, cy {:.6g} pixels, baseline {:.6g} m\n",
                 camera.rectified ? "undistorted" : "rectified", c.fx, c.fy, c.cx, c.cy,
                 camera.rectified ? camera.baseline : c.baseline);
    }
    const auto warn = [](const char* whose, const slam::LensCamera& lens) {
      for (const std::string& doubt : slam::check_camera(as_given(lens))) log_warning("{}{}", whose, doubt);
    };
    warn(camera.rectified ? "" : "left camera: ", camera.left);
    if (!camera.rectified) warn("right camera: ", camera.right);
  } else if (!camera.rectified) {
    log_warning(
        "the file does not say the size of the images: give it by --size, or that of the first image counts");
  }
  if (options.output.empty()) return;
  if (!has_size && (!camera.rectified || !camera.left.distortion.empty()))
    throw UsageError(fmt::format(
        "{}: not written, for the images' size is missing to undo the lenses: --size WIDTHxHEIGHT",
        options.output));
  nn::write_file(options.output, slam::calibration_text(camera));
  log_info("{}: written", options.output);
}

}  // namespace

void add_calibration_command(CLI::App& app) {
  auto options = std::make_shared<CalibrationOptions>();
  CLI::App* command =
      app.add_subcommand("calibration", "Say what a camera's calibration file means, whoever wrote it");
  command
      ->add_option(
          "files", options->files,
          "Kalibr's camchain, OpenVINS, OpenCV, ROS, ORB-SLAM, Basalt, ETH3D or ours; two files, the left\n"
          "camera's first, of ROS or EuRoC")
      ->required()
      ->expected(1, 2);
  command->add_option("--size", options->size,
                      "WxH of the images, where the file does not say it; -o needs it of raw lenses");
  command->add_option("-o,--output", options->output,
                      "write it as a calibration.yaml of Penumbra's own keys");
  command->footer(
      "Examples:\n"
      "  penumbra calibration camchain.yaml\n"
      "  penumbra calibration left.yaml right.yaml -o calibration.yaml\n"
      "  penumbra calibration stereo.yml --size 752x480\n\n"
      "`penumbra slam` reads all of them under the name calibration.yaml. docs/datasets.md.\n");
  command->callback([options] { calibration(*options); });
}

}  // namespace penumbra::apps
