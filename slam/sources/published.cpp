#include "slam/sources/published.h"

#include <fmt/core.h>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/number_file.h"
#include "nn/base/text.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/sources/folder_listing.h"
#include "slam/sources/kitti_raw.h"
#include "slam/sources/paired_folders.h"
#include "slam/sources/robotcar.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

// A folder's own lens, in pixels, and metres between the cameras.
CameraFile pinhole_pair(double fx, double fy, double cx, double cy, double baseline, int width, int height) {
  CameraFile camera;
  camera.left = {fx, fy, cx, cy, LensModel::radial_tangential, {}, width, height};
  camera.baseline = baseline;
  return camera;
}

CameraFile file_of(const StereoCamera& c) {
  return pinhole_pair(c.fx, c.fy, c.cx, c.cy, c.baseline, c.width, c.height);
}

bool wants_colour(const DatasetOptions& options) { return options.cameras == DatasetCameras::colour; }

// ---- KITTI raw data

bool is_kitti_raw(const fs::path& path) {
  return is_folder(path / "image_00" / "data") || is_folder(path / "image_02" / "data");
}

PairedFolders kitti_raw(const fs::path& path, const DatasetOptions& options) {
  const bool colour = wants_colour(options) || !is_folder(path / "image_00");
  const int left = colour ? 2 : 0;
  PairedFolders folders;
  folders.name = "KITTI raw " + path.filename().string();
  folders.first = path / fmt::format("image_0{}", left) / "data";
  folders.second = path / fmt::format("image_0{}", left + 1) / "data";
  const fs::path calibration = path.parent_path() / "calib_cam_to_cam.txt";
  folders.camera = file_of(read_kitti_raw_calibration(calibration, left, left + 1));
  folders.camera.colour = colour;
  const fs::path times = folders.first.parent_path() / "timestamps.txt";
  if (is_present(times)) folders.times = {times, read_date_list(times)};
  const std::optional<Mounting> imu = read_kitti_raw_mounting(path.parent_path(), left);
  if (imu) folders.camera.mountings.push_back(*imu);
  if (!is_folder(path / "oxts" / "data")) return folders;
  if (imu) {
    folders.numbered_truth = read_oxts_poses(path, imu->T_frame_camera);
  } else {
    folders.notes.push_back(fmt::format(
        "no ground truth: calib_imu_to_velo.txt and calib_velo_to_cam.txt, which carry oxts/ to the "
        "camera, are not both in {}",
        path.parent_path().string()));
  }
  return folders;
}

// ---- KITTI-360

bool is_kitti_360(const fs::path& path) { return is_folder(path / "image_00" / "data_rect"); }

PairedFolders kitti_360(const fs::path& path, const DatasetOptions&) {
  const fs::path root = path.parent_path().parent_path();
  PairedFolders folders;
  folders.name = "KITTI-360 " + path.filename().string();
  folders.first = path / "image_00" / "data_rect";
  folders.second = path / "image_01" / "data_rect";
  folders.camera = file_of(read_kitti_raw_calibration(root / "calibration" / "perspective.txt", 0, 1));
  if (const auto imu = read_kitti_360_mounting(root / "calibration"))
    folders.camera.mountings.push_back(*imu);
  const fs::path times = path / "image_00" / "timestamps.txt";
  if (is_present(times)) folders.times = {times, read_date_list(times)};
  folders.rate = 10.0;
  const fs::path poses = root / "data_poses" / path.filename() / "cam0_to_world.txt";
  if (is_present(poses)) folders.numbered_truth = read_kitti_trajectory(poses, &folders.notes);
  return folders;
}

// ---- Virtual KITTI 2

bool is_virtual_kitti(const fs::path& path) { return is_folder(path / "frames" / "rgb" / "Camera_0"); }

// "frame cameraID" and T_cw, 4 x 4, a line; a heading names the columns.
Trajectory read_virtual_kitti_poses(const fs::path& path) {
  Trajectory truth;
  nn::LineReader reader(path, "Virtual KITTI's extrinsic.txt");
  while (const std::optional<std::string_view> line = reader.next()) {
    if (line->starts_with("frame")) continue;
    const std::vector<double> v = nn::parse_numbers(*line, reader.place());
    if (v.size() != 18)
      throw InputError(reader.place(), "frame, camera and 16 numbers", fmt::format("{}", v.size()));
    if (v[1] != 0.0) continue;
    truth.push_back({v[0], rigid_motion({v.begin() + 2, v.end()}, reader.place()).inverse()});
  }
  return truth;
}

PairedFolders virtual_kitti(const fs::path& path, const DatasetOptions&) {
  PairedFolders folders;
  folders.name = "Virtual KITTI 2 " + path.parent_path().filename().string() + " " + path.filename().string();
  folders.first = path / "frames" / "rgb" / "Camera_0";
  folders.second = path / "frames" / "rgb" / "Camera_1";
  // Of all its scenes, as its page says.
  folders.camera = pinhole_pair(725.0087, 725.0087, 620.5, 187.0, 0.532725, 1242, 375);
  folders.rate = 10.0;
  const fs::path poses = path / "extrinsic.txt";
  if (is_present(poses)) folders.numbered_truth = read_virtual_kitti_poses(poses);
  return folders;
}

// ---- TartanAir

bool is_tartanair(const fs::path& path) {
  return is_folder(path / "image_left") && is_folder(path / "image_right");
}

// Its world and its camera look along +x with y to the right and z down: "north, east, down".
SE3 from_north_east_down(const SE3& T) {
  Eigen::Matrix3d optical;  // from (x right, y down, z ahead)
  optical << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  return {optical.transpose() * T.rotation * optical, optical.transpose() * T.translation};
}

PairedFolders tartanair(const fs::path& path, const DatasetOptions&) {
  PairedFolders folders;
  folders.name = "TartanAir " + path.filename().string();
  folders.first = path / "image_left";
  folders.second = path / "image_right";
  folders.camera = pinhole_pair(320.0, 320.0, 320.0, 240.0, 0.25, 0, 0);
  folders.made_for = Size{640, 480};
  folders.rate = 10.0;
  folders.notes.emplace_back("TartanAir has no times: 10 frames a second are taken (--rate HZ for another)");
  if (const fs::path file = path / "pose_left.txt"; is_present(file)) {
    folders.poses.file = file;
    for (const TimedPose& pose : read_tartanair_trajectory(file, &folders.notes))
      folders.poses.lines.push_back(from_north_east_down(pose.T_wc));
  }
  return folders;
}

// ---- 4Seasons

bool is_four_seasons(const fs::path& path) { return is_folder(path / "undistorted_images" / "cam0"); }

PairedFolders four_seasons(const fs::path& path, const DatasetOptions&) {
  PairedFolders folders;
  folders.name = "4Seasons " + path.filename().string();
  folders.first = path / "undistorted_images" / "cam0";
  folders.second = path / "undistorted_images" / "cam1";
  const fs::path calibration = path.parent_path() / "calibration";
  const fs::path lens = calibration / "undistorted_calib_0.txt",
                 stereo = calibration / "undistorted_calib_stereo.txt";
  nn::LineReader reader(lens, "4Seasons' calibration of the left camera");
  const std::string_view line = reader.next().value_or("");
  if (!line.starts_with("Pinhole "))
    throw InputError(lens.string() + ":1", "Pinhole fx fy cx cy 0", fmt::format("'{}'", printable(line, 40)));
  const std::vector<double> K = nn::parse_numbers(line.substr(8), lens.string() + ":1");
  if (K.size() < 4)
    throw InputError(lens.string() + ":1", "Pinhole fx fy cx cy 0", counted(K.size(), "number"));
  std::vector<double> T;
  nn::LineReader rows(stereo, "4Seasons' calibration between the cameras (4 x 4 numbers)");
  while (const std::optional<std::string_view> row = rows.next()) {
    for (const double value : nn::parse_numbers(*row, rows.place())) T.push_back(value);
  }
  const double baseline = rigid_motion(T, stereo.string()).translation.norm();
  folders.camera = pinhole_pair(K[0], K[1], K[2], K[3], baseline, 0, 0);
  if (const fs::path file = path / "groundtruth.txt"; is_present(file))
    folders.truth = read_tum_trajectory(file, &folders.notes);
  return folders;
}

// ---- ICL-NUIM

bool is_icl_nuim(const fs::path& path) {
  return is_folder(path / "rgb") && is_folder(path / "depth") && is_present(path / "associations.txt") &&
         !is_present(path / "rgb.txt") && !is_present(path / "calibration.yaml");
}

PairedFolders icl_nuim(const fs::path& path, const DatasetOptions&) {
  PairedFolders folders;
  folders.name = "ICL-NUIM " + path.filename().string();
  folders.first = path / "rgb";
  folders.second = path / "depth";
  // Its fy is -480: y of its camera and its world points up, which is the mirror image of ours.
  folders.camera = pinhole_pair(481.2, 480.0, 319.5, 239.5, kNominalBaseline, 640, 480);
  folders.camera.sensor = Sensor::rgbd;
  folders.camera.depth_factor = 5000.0;
  folders.rate = 30.0;
  for (const fs::path& file : list_folder(path)) {
    if (!file.filename().string().ends_with(".gt.freiburg")) continue;
    const Eigen::Vector3d mirror(1.0, -1.0, 1.0);
    folders.numbered_truth = read_tum_trajectory(file, &folders.notes);
    for (TimedPose& pose : folders.numbered_truth) {
      pose.T_wc = {mirror.asDiagonal() * pose.T_wc.rotation * mirror.asDiagonal(),
                   mirror.asDiagonal() * pose.T_wc.translation};
    }
    break;
  }
  return folders;
}

PairedFolders robotcar(const fs::path& path, const DatasetOptions&) { return describe_robotcar(path); }

struct Row {
  bool (*looks_like)(const fs::path&);
  PairedFolders (*describe)(const fs::path&, const DatasetOptions&);
};
constexpr Row kRows[] = {
    {is_kitti_360, kitti_360}, {is_kitti_raw, kitti_raw},       {is_virtual_kitti, virtual_kitti},
    {is_tartanair, tartanair}, {is_four_seasons, four_seasons}, {is_icl_nuim, icl_nuim},
    {is_robotcar, robotcar},
};

}  // namespace

bool looks_like_published(const fs::path& path) {
  for (const Row& row : kRows) {
    if (row.looks_like(path)) return true;
  }
  return false;
}

std::unique_ptr<StereoDataset> open_published(const fs::path& path, const DatasetOptions& options) {
  require_dataset_folder(path);
  const fs::path folder = fs::canonical(path);
  for (const Row& row : kRows) {
    if (!row.looks_like(folder)) continue;
    PairedFolders folders = row.describe(folder, options);
    folders.place = folder;
    return open_paired_folders(std::move(folders), options);
  }
  throw InputError(folder.string(), "a published data set that docs/datasets.md names", "none of them");
}

}  // namespace penumbra::slam
