#include "slam/world/office_sequence.h"

#include <filesystem>

#include "nn/base/error.h"
#include "slam/world/hand_held_path.h"
#include "slam/world/office_builder.h"

namespace penumbra::slam::synthetic {

namespace {

constexpr int kUsualFrames = 300, kUsualLapFrames = 1500;

bool is_pose_file(const std::string& path) { return path.find_first_of("./") != std::string::npos; }

Trajectory poses_of(const OfficeSettings& settings) {
  HandHeldPath path;
  path.kind = settings.path;
  path.rate = kOfficeRate;
  path.seed = settings.seed;
  if (is_pose_file(settings.path)) {
    return recorded_trajectory(settings.path, looking_at(path.stand, path.target), kOfficeRate,
                               settings.frames);
  }
  const int usual = settings.path == "twolaps" ? kUsualLapFrames : kUsualFrames;
  return hand_held_trajectory(path, settings.frames == 0 ? usual : settings.frames);
}

Scene office_scene(const OfficeSettings& settings) {
  settings.check();
  OfficePlan plan;
  // Room for a loop of 7 m by 5 m.
  if (settings.path == "twolaps") plan = {.half_x = 4.9, .half_z = 3.9};
  Scene scene;
  scene.poses = poses_of(settings);
  scene.world = build_office(plan, settings.people, scene.poses.back().timestamp + 1.0, settings.seed);
  scene.world.texture = settings.texture;
  scene.camera = office_camera(settings.size);
  scene.rate = kOfficeRate;
  const std::string path =
      is_pose_file(settings.path)
          ? fmt::format("along {}", std::filesystem::path(settings.path).filename().string())
          : settings.path;
  const char* people = settings.people == People::walking   ? "walking"
                       : settings.people == People::sitting ? "sitting"
                                                            : "no";
  scene.name = fmt::format("synthetic office, {} people, {}, seed {}", people, path, settings.seed);
  return scene;
}

Recording office_recording(const OfficeSettings& settings) {
  return {.sensor = Sensor::rgbd,
          .seed = settings.seed,
          .annotations = settings.annotations,
          .colour = true,
          .depth = true,
          .flow = settings.flow,
          .amodal = settings.amodal,
          .landmarks = settings.landmarks,
          .exposure_change = settings.exposure_change,
          .noise = settings.noise,
          .shutter = settings.shutter,
          .readout = settings.readout,
          .depth_delay = settings.depth_delay,
          .depth_camera = settings.depth_camera};
}

}  // namespace

StereoCamera office_camera(const Size& size) {
  StereoCamera camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.fx = 535.4 / 640.0 * size.width;
  camera.fy = 539.2 / 480.0 * size.height;
  camera.cx = 320.1 / 640.0 * size.width;
  camera.cy = 247.6 / 480.0 * size.height;
  return camera;
}

OfficeSequence::OfficeSequence(const OfficeSettings& settings)
    : Sequence(office_scene(settings), office_recording(settings)) {}

}  // namespace penumbra::slam::synthetic
