#include "slam/sources/kitti_raw.h"

#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/number_file.h"
#include "nn/base/text.h"
#include "slam/sources/calibration/camera_file.h"
#include "slam/sources/calibration/lens_reader.h"
#include "slam/sources/folder_listing.h"
#include "slam/sources/kitti_calibration.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

// Lines "label: numbers".
class LabelledNumbers {
 public:
  LabelledNumbers(const fs::path& path, std::string_view expected) : path_(path) {
    nn::LineReader reader(path, expected);
    while (const std::optional<std::string_view> line = reader.next()) {
      const std::size_t colon = line->find(':');
      if (colon == std::string_view::npos) continue;
      lines_.try_emplace(std::string(line->substr(0, colon)),
                         Line{reader.place(), std::string(line->substr(colon + 1))});
    }
  }
  std::vector<double> numbers(const std::string& label, std::size_t count) const {
    const auto at = lines_.find(label);
    const std::string expected = fmt::format("'{}:' with {} numbers", label, count);
    if (at == lines_.end()) throw InputError(path_.string(), expected, "no such line");
    std::vector<double> values = nn::parse_numbers(at->second.text, at->second.place);
    if (values.size() != count)
      throw InputError(at->second.place, expected, fmt::format("{}", values.size()));
    return values;
  }
  std::string place(const std::string& label) const { return lines_.at(label).place; }
  SE3 motion() const { return rigid_motion(numbers("R", 9), numbers("T", 3), path_.string()); }

 private:
  struct Line {
    std::string place, text;
  };
  fs::path path_;
  std::map<std::string, Line> lines_;
};

std::string camera_label(const char* what, int camera) { return fmt::format("{}_rect_0{}", what, camera); }

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kEarthRadius = 6378137.0;  // metres

// lat lon alt roll pitch yaw, and what else the sensor measures.
std::vector<double> read_packet(const fs::path& path) {
  nn::LineReader reader(path, "a packet of KITTI's inertial sensor");
  std::vector<double> v = nn::parse_numbers(reader.next().value_or(""), path.string());
  if (v.size() < 6)
    throw InputError(path.string(), "lat lon alt roll pitch yaw", counted(v.size(), "number"));
  return v;
}

// T_w_imu.
SE3 pose_of_packet(const std::vector<double>& v, double scale) {
  return {so3_from_roll_pitch_yaw(v[3], v[4], v[5]),
          {scale * kEarthRadius * v[1] * kRadians,
           scale * kEarthRadius * std::log(std::tan((90.0 + v[0]) * kRadians / 2.0)), v[2]}};
}

}  // namespace

StereoCamera read_kitti_raw_calibration(const fs::path& path, int left, int right) {
  const LabelledNumbers file(path, "the calibration of KITTI's raw data, P_rect_00 and so on");
  const auto projection = [&](int camera) -> ProjectionRow {
    std::vector<double> values = file.numbers(camera_label("P", camera), 12);
    return {file.place(camera_label("P", camera)), std::move(values)};
  };
  StereoCamera camera = pair_of(projection(left), projection(right), left);
  const std::vector<double> size = file.numbers(camera_label("S", left), 2);
  LensCamera lens;
  set_size(lens, size[0], size[1], file.place(camera_label("S", left)));
  camera.width = lens.width;
  camera.height = lens.height;
  return camera;
}

std::vector<double> read_date_list(const fs::path& path) {
  std::vector<double> seconds;
  nn::LineReader reader(path, "KITTI's timestamps.txt");
  while (const std::optional<std::string_view> line = reader.next()) {
    int year = 0, hour = 0, minute = 0, used = 0;
    unsigned month = 0, day = 0;
    double second = 0.0;
    const std::string text(*line);
    const int found = std::sscanf(text.c_str(), "%d-%u-%u %d:%d:%lf%n", &year, &month, &day, &hour, &minute,
                                  &second, &used);
    const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month),
                                           std::chrono::day(day)};
    if (found != 6 || used != static_cast<int>(text.size()) || !date.ok() || hour < 0 || hour > 23 ||
        minute < 0 || minute > 59 || !(second >= 0.0 && second < 61.0)) {
      throw InputError(reader.place(), "a date and a time, 2011-09-26 13:02:25.064389445",
                       fmt::format("'{}'", printable(text, 40)));
    }
    const auto days = std::chrono::sys_days(date).time_since_epoch().count();
    seconds.push_back(static_cast<double>(days) * 86400.0 + hour * 3600.0 + minute * 60.0 + second);
  }
  return seconds;
}

std::optional<Mounting> read_kitti_raw_mounting(const fs::path& day, int left) {
  const fs::path velo = day / "calib_imu_to_velo.txt", cam = day / "calib_velo_to_cam.txt";
  if (!is_present(velo) || !is_present(cam)) return std::nullopt;
  const LabelledNumbers cameras(day / "calib_cam_to_cam.txt", "the calibration of KITTI's raw data");
  const std::vector<double> P = cameras.numbers(camera_label("P", left), 12);
  const SE3 T_left_cam0 =
      rigid_motion(cameras.numbers("R_rect_00", 9), {P[3] / P[0], 0.0, 0.0}, cameras.place("R_rect_00"));
  const SE3 T_left_imu = T_left_cam0 * LabelledNumbers(cam, "KITTI's calib_velo_to_cam.txt").motion() *
                         LabelledNumbers(velo, "KITTI's calib_imu_to_velo.txt").motion();
  return Mounting{"imu", T_left_imu.inverse()};
}

std::optional<Mounting> read_kitti_360_mounting(const fs::path& calibration) {
  const fs::path poses = calibration / "calib_cam_to_pose.txt";
  if (!is_present(poses)) return std::nullopt;
  const LabelledNumbers cameras(calibration / "perspective.txt", "the calibration of KITTI-360");
  const LabelledNumbers mounted(poses, "KITTI-360's calib_cam_to_pose.txt");
  const SE3 T_imu_cam0 = rigid_motion(mounted.numbers("image_00", 12), mounted.place("image_00"));
  const SE3 T_left_cam0 =
      rigid_motion(cameras.numbers("R_rect_00", 9), {0.0, 0.0, 0.0}, cameras.place("R_rect_00"));
  return Mounting{"imu", T_imu_cam0 * T_left_cam0.inverse()};
}

Trajectory read_oxts_poses(const fs::path& drive, const SE3& T_imu_camera) {
  Trajectory poses;
  const std::vector<fs::path> packets = list_folder(drive / "oxts" / "data");
  if (packets.empty()) return poses;
  const std::vector<double> first = read_packet(packets.front());
  const double scale = std::cos(first[0] * kRadians);
  const SE3 T_first_w = (pose_of_packet(first, scale) * T_imu_camera).inverse();
  for (const fs::path& packet : packets) {
    const std::optional<double> number = number_in_name(packet.stem().string());
    if (number)
      poses.push_back({*number, T_first_w * pose_of_packet(read_packet(packet), scale) * T_imu_camera});
  }
  return poses;
}

}  // namespace penumbra::slam
