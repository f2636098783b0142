#include <fmt/core.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/sources/calibration/dialects.h"
#include "slam/sources/calibration/lens_reader.h"

namespace penumbra::slam {

namespace {

using Json = nlohmann::json;

// A value below `json`, and where it is for messages: "calib.json: value0.intrinsics[1].fx".
class Entry {
 public:
  Entry(const Json& json, std::string place) : json_(json), place_(std::move(place)) {}

  Entry of(const char* key) const {
    if (!json_.is_object() || !json_.contains(key))
      throw InputError(place_, fmt::format("the key {}", key), "no such key");
    return {json_.at(key), fmt::format("{}.{}", place_, key)};
  }
  Entry at(std::size_t i) const {
    if (!json_.is_array() || json_.size() <= i)
      throw InputError(place_, fmt::format("a list of at least {}", i + 1),
                       json_.is_array() ? fmt::format("{}", json_.size()) : json_.type_name());
    return {json_.at(i), fmt::format("{}[{}]", place_, i)};
  }
  double number() const {
    if (!json_.is_number()) throw InputError(place_, "a number", json_.type_name());
    return json_.get<double>();
  }
  std::string text() const {
    if (!json_.is_string()) throw InputError(place_, "a text", json_.type_name());
    return json_.get<std::string>();
  }
  std::size_t size() const { return json_.size(); }
  const std::string& place() const { return place_; }

 private:
  const Json& json_;
  std::string place_;
};

LensCamera read_basalt_lens(const Entry& camera, const Entry& size) {
  LensCamera lens;
  const Entry values = camera.of("intrinsics");
  set_intrinsics(lens,
                 {values.of("fx").number(), values.of("fy").number(), values.of("cx").number(),
                  values.of("cy").number()},
                 values.place());
  set_size(lens, size.at(0).number(), size.at(1).number(), size.place());
  const std::string model = camera.of("camera_type").text();
  if (model == "kb4") {
    set_lens_model(lens, "equidistant",
                   {values.of("k1").number(), values.of("k2").number(), values.of("k3").number(),
                    values.of("k4").number()},
                   values.place());
  } else if (model != "pinhole") {
    throw InputError(camera.place() + ".camera_type", "kb4 or pinhole", fmt::format("'{}'", model));
  }
  return lens;
}

// T_imu_cam: a translation px py pz and a quaternion qx qy qz qw.
SE3 read_basalt_pose(const Entry& pose) {
  const Eigen::Quaterniond q(pose.of("qw").number(), pose.of("qx").number(), pose.of("qy").number(),
                             pose.of("qz").number());
  if (!(std::abs(q.norm() - 1.0) < 1e-3))
    throw InputError(pose.place(), "a quaternion of length 1", fmt::format("{:g}", q.norm()));
  return {q.normalized().toRotationMatrix(),
          {pose.of("px").number(), pose.of("py").number(), pose.of("pz").number()}};
}

}  // namespace

CameraFile read_basalt(const std::filesystem::path& path) {
  const std::string text = nn::read_text_file(path, "a calibration");
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) throw InputError(path.string(), "JSON", "something else");
  const Entry all = Entry(json, path.string()).of("value0");
  const Entry cameras = all.of("intrinsics"), sizes = all.of("resolution"), poses = all.of("T_imu_cam");
  CameraFile file;
  file.rectified = false;
  file.place = poses.place();
  file.left = read_basalt_lens(cameras.at(0), sizes.at(0));
  file.right = read_basalt_lens(cameras.at(1), sizes.at(1));
  const SE3 T_imu_left = read_basalt_pose(poses.at(0));
  file.T_right_left = read_basalt_pose(poses.at(1)).inverse() * T_imu_left;
  file.mountings.push_back({"imu", T_imu_left});
  if (cameras.size() > 2) file.notes.emplace_back("of more than two cameras the first two are taken");
  return file;
}

}  // namespace penumbra::slam
