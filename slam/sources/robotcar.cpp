#include "slam/sources/robotcar.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/number_file.h"
#include "nn/base/text.h"
#include "nn/image/image_file.h"
#include "slam/sources/folder_listing.h"
#include "slam/sources/robotcar_poses.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

// The SDK's folder `name`, wherever it was put.
std::optional<fs::path> find_sdk_folder(const fs::path& drive, const char* name) {
  for (const fs::path& place : {drive, drive.parent_path()}) {
    for (const fs::path& folder : {place / name, place / "robotcar-dataset-sdk" / name}) {
      if (is_folder(folder)) return folder;
    }
  }
  return std::nullopt;
}

fs::path require_models(const fs::path& drive) {
  if (const auto models = find_sdk_folder(drive, "models")) return *models;
  throw InputError(drive.string(),
                   "the models/ of RobotCar's SDK, which undo its lenses, in it or beside it (git clone "
                   "https://github.com/ori-mrg/robotcar-dataset-sdk, beside the recording)",
                   "none");
}

// ---- The camera

struct Model {
  LensCamera lens;
  SE3 T_camera_image;
  Remap undo;
};

Remap read_table(const fs::path& path, const Size& size) {
  const std::string bytes = nn::read_file(path, "RobotCar's table of a lens");
  const auto pixels = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
  if (bytes.size() != 2 * sizeof(double) * pixels) {
    throw InputError(path.string(),
                     fmt::format("{} bytes, columns and rows of {} x {} pixels", 2 * sizeof(double) * pixels,
                                 size.width, size.height),
                     fmt::format("{} bytes", bytes.size()));
  }
  FloatImage places[2] = {{size.width, size.height}, {size.width, size.height}};
  for (std::size_t i = 0; i < 2 * pixels; ++i) {
    double value = 0.0;
    std::memcpy(&value, bytes.data() + sizeof(double) * i, sizeof(double));
    if (!std::isfinite(value))
      throw InputError(path.string(), "finite places", fmt::format("{:g} at {}", value, i));
    places[i / pixels].data()[i % pixels] = static_cast<float>(value);
  }
  return {places[0], places[1], size};
}

Model read_model(const fs::path& models, const std::string& name, const Size& size) {
  const fs::path file = models / (name + ".txt");
  nn::NumberFileReader reader(file, "fx fy cx cy, then a 4 x 4 matrix");
  const auto numbers = [&](std::size_t count) {
    const auto line = reader.next();
    if (!line || line->values.size() < count)
      throw InputError(line ? reader.place() : file.string(), fmt::format("a line of {} numbers", count),
                       line ? fmt::format("{}", line->values.size()) : "the end");
    return line->values;
  };
  Model model;
  const std::vector<double> K = numbers(4);
  model.lens = {K[0], K[1], K[2], K[3], LensModel::radial_tangential, {}, size.width, size.height};
  std::vector<double> T;
  for (int row = 0; row < 4; ++row) {
    const std::vector<double> values = numbers(4);
    T.insert(T.end(), values.begin(), values.begin() + 4);
  }
  model.T_camera_image = rigid_motion(T, file.string());
  model.undo = read_table(models / (name + "_distortion_lut.bin"), size);
  return model;
}

// The tables rectify, too: both images are then of one camera.
RecordedCamera camera_of(const Model& left, const Model& right, const std::string& place) {
  constexpr double kPixels = 1e-3, kTurn = 1e-5, kMetres = 1e-4;
  const LensCamera &l = left.lens, &r = right.lens;
  const SE3 T_left_right = left.T_camera_image.inverse() * right.T_camera_image;
  const Eigen::Vector3d& t = T_left_right.translation;
  const double differ =
      std::max({std::abs(l.fx - r.fx), std::abs(l.fy - r.fy), std::abs(l.cx - r.cx), std::abs(l.cy - r.cy)});
  const bool is_rectified = differ <= kPixels && T_left_right.angle() <= kTurn &&
                            std::max(std::abs(t.y()), std::abs(t.z())) <= kMetres && t.x() > 0.0;
  if (!is_rectified) {
    throw InputError(place, "models of a rectified pair, the right camera to the right",
                     fmt::format("lenses that differ by {:g} pixels, the right one at ({:g}, {:g}, {:g}) m",
                                 differ, t.x(), t.y(), t.z()));
  }
  RecordedCamera camera;
  camera.camera.fx = l.fx;
  camera.camera.fy = l.fy;
  camera.camera.cx = l.cx;
  camera.camera.cy = l.cy;
  camera.camera.width = l.width;
  camera.camera.height = l.height;
  camera.camera.baseline = t.x();
  camera.left = left.undo;
  camera.right = right.undo;
  return camera;
}

// ---- The truth

// "MICROSECONDS CHUNK" a line.
std::vector<double> read_timestamps(const fs::path& path) {
  std::vector<double> times;
  nn::NumberFileReader reader(path, "microseconds and a number of the download");
  while (const auto line = reader.next()) times.push_back(kRobotCarTime * line->values.front());
  return times;
}

// Nothing where the file is missing.
std::optional<SE3> read_extrinsic(const std::optional<fs::path>& folder, const char* name) {
  if (!folder || !is_present(*folder / name)) return std::nullopt;
  return robotcar_motion(
      nn::read_number_file(*folder / name, 6, "x y z roll pitch yaw").front().values.data());
}

void add_truth(const fs::path& drive, const Model& left, PairedFolders& folders) {
  const auto extrinsics = find_sdk_folder(drive, "extrinsics");
  const std::optional<SE3> T_camera_vehicle = read_extrinsic(extrinsics, "stereo.txt"),
                           T_vehicle_ins = read_extrinsic(extrinsics, "ins.txt");
  if (T_camera_vehicle) folders.made->stands({"vehicle", T_camera_vehicle->inverse() * left.T_camera_image});
  if (T_camera_vehicle && T_vehicle_ins) {
    folders.made->stands({"ins", (*T_camera_vehicle * *T_vehicle_ins).inverse() * left.T_camera_image});
  }
  Trajectory poses;
  std::string body = "ins";
  for (const fs::path& file :
       {drive / "rtk.csv", drive / "rtk" / "rtk.csv", drive / "gps" / "rtk.csv", drive / "gps" / "ins.csv"}) {
    if (poses.empty() && is_present(file)) poses = read_robotcar_inertial(file);
  }
  if (const fs::path file = drive / "vo" / "vo.csv"; poses.empty() && is_present(file)) {
    poses = read_robotcar_odometry(file);
    body = "vehicle";
    folders.notes.push_back(fmt::format(
        "{}: the data set's own visual odometry, which drifts, is taken as truth", file.string()));
  }
  if (poses.empty()) return;
  const auto mounting = std::find_if(folders.made->mountings.begin(), folders.made->mountings.end(),
                                     [&](const Mounting& m) { return m.frame == body; });
  if (mounting == folders.made->mountings.end()) {
    folders.notes.push_back(
        fmt::format("no ground truth: extrinsics/{} of RobotCar's SDK is needed to carry it to the camera",
                    T_camera_vehicle ? "ins.txt" : "stereo.txt"));
    return;
  }
  if (const fs::path times = drive / "stereo.timestamps"; is_present(times))
    poses = interpolated(poses, read_timestamps(times));
  if (poses.empty()) return;
  const SE3 T_first_w = poses.front().T_wc.inverse();  // its world is as wide as the country
  for (TimedPose& pose : poses) pose.T_wc = T_first_w * pose.T_wc * mounting->T_frame_camera;
  folders.truth = std::move(poses);
}

}  // namespace

bool is_robotcar(const fs::path& path) {
  const fs::path stereo = path / "stereo";
  return is_folder(stereo / "right") && (is_folder(stereo / "left") || is_folder(stereo / "centre"));
}

PairedFolders describe_robotcar(const fs::path& drive) {
  const bool wide = is_folder(drive / "stereo" / "left");
  const fs::path models = require_models(drive);
  PairedFolders folders;
  folders.name = "RobotCar " + drive.filename().string();
  folders.first = drive / "stereo" / (wide ? "left" : "centre");
  folders.second = drive / "stereo" / "right";
  const std::vector<fs::path> images = list_images(folders.first, folders.notes);
  const nn::ImageInfo info = nn::read_image_info(images.front());
  const std::string pair = wide ? "stereo_wide_" : "stereo_narrow_";
  const Model left = read_model(models, pair + "left", {info.width, info.height}),
              right = read_model(models, pair + "right", {info.width, info.height});
  folders.made = camera_of(left, right, models.string());
  folders.mosaic = BayerPattern::gbrg;
  if (!wide)
    folders.notes.emplace_back("there is no stereo/left: the narrow pair, centre and right, is taken");
  add_truth(drive, left, folders);
  return folders;
}

}  // namespace penumbra::slam
