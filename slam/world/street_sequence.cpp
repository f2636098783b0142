#include "slam/world/street_sequence.h"

#include <filesystem>
#include <utility>

#include "nn/base/error.h"

namespace penumbra::slam::synthetic {

namespace {

constexpr int kDefaultFrames = 60;

const SequenceSettings& checked(const SequenceSettings& settings) {
  check_extent(settings.size, settings.frames);
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

// For logs and reports, such as "synthetic street, block, seed 1".
std::string name_of(const SequenceSettings& settings) {
  const bool is_file = std::filesystem::path(settings.path).has_extension();
  return fmt::format(
      "synthetic street, {}, seed {}",
      is_file ? "along " + std::filesystem::path(settings.path).filename().string() : settings.path,
      settings.seed);
}

Scene scene_of(const SequenceSettings& settings) {
  Drive drive = drive_of(checked(settings));
  return {.world = build_street(drive, settings.street, settings.seed),
          .camera = street_camera(settings.size),
          .poses = std::move(drive.poses),
          .rate = kFrameRate,
          .name = name_of(settings)};
}

Recording recording_of(const SequenceSettings& settings) {
  return {.sensor = settings.sensor,
          .seed = settings.seed,
          .annotations = settings.annotations,
          .colour = settings.colour,
          .depth = settings.depth,
          .disparity = settings.disparity,
          .flow = settings.flow,
          .amodal = settings.amodal,
          .landmarks = settings.landmarks,
          .exposure_change = settings.street.exposure_change,
          .noise = settings.street.noise,
          .shutter = settings.street.shutter,
          .glare = settings.street.glare,
          .depth_camera = {}};
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
    : Sequence(scene_of(settings), recording_of(settings)) {}

}  // namespace penumbra::slam::synthetic
