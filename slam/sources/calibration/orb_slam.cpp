#include <fmt/core.h>

#include "nn/base/error.h"
#include "slam/sources/calibration/dialects.h"
#include "slam/sources/calibration/lens_reader.h"
#include "slam/sources/calibration/yaml_words.h"

namespace penumbra::slam {

namespace {

bool is_orb_slam(const YamlFile& yaml) { return yaml.has("Camera.fx") || yaml.has("Camera1.fx"); }

// k1 k2 p1 p2 [k3], or k1 k2 k3 k4 of ORB-SLAM3's KannalaBrandt8; empty where all are 0 or missing.
std::vector<double> orb_distortion(const YamlFile& yaml, const std::string& camera, bool fisheye) {
  std::vector<double> coefficients;
  bool is_any = false;
  for (const char* name : {"k1", "k2", fisheye ? "k3" : "p1", fisheye ? "k4" : "p2", "k3"}) {
    if (coefficients.size() == 4 && (fisheye || !yaml.has(camera + "k3"))) break;
    coefficients.push_back(yaml.number_or(camera + name, 0.0));
    is_any = is_any || coefficients.back() != 0.0;
  }
  return is_any ? coefficients : std::vector<double>();
}

LensCamera read_orb_lens(const YamlFile& yaml, const std::string& camera, const std::string& model) {
  LensCamera lens;
  const bool fisheye = model == "kannalabrandt8";
  set_intrinsics(lens,
                 {yaml.number(camera + "fx"), yaml.number(camera + "fy"), yaml.number(camera + "cx"),
                  yaml.number(camera + "cy")},
                 yaml.place(camera + "fx"));
  if (yaml.has("Camera.width"))
    set_size(lens, yaml.number("Camera.width"), yaml.number("Camera.height"), yaml.place("Camera.width"));
  const std::vector<double> distortion = orb_distortion(yaml, camera, fisheye);
  if (!distortion.empty())
    set_lens_model(lens, fisheye ? "equidistant" : "radial-tangential", distortion,
                   yaml.place(camera + "k1"));
  return lens;
}

// ORB-SLAM2's stereo pair of raw images: the lens of one, and what rectifies it.
struct RawSide {
  LensCamera lens;
  Eigen::Matrix3d R;
  double base = 0.0;  // metres along the rows
};

RawSide read_raw_side(const YamlFile& yaml, const std::string& side) {
  RawSide raw;
  const std::string K = matrix_key(yaml, side + "K"), D = matrix_key(yaml, side + "D"),
                    R = matrix_key(yaml, side + "R"), P = matrix_key(yaml, side + "P");
  set_intrinsics(raw.lens, yaml.numbers(K, 9), yaml.place(K));
  set_size(raw.lens, yaml.number(side + "width"), yaml.number(side + "height"), yaml.place(side + "width"));
  set_lens_model(raw.lens, "radial-tangential", yaml.numbers(D), yaml.place(D));
  raw.R = rigid_motion(yaml.numbers(R, 9), {0.0, 0.0, 0.0}, yaml.place(R)).rotation;
  const std::vector<double> p = yaml.numbers(P, 12);
  if (!(p[0] > 0.0)) throw InputError(yaml.place(P), "a focal length > 0", fmt::format("{:g}", p[0]));
  raw.base = -p[3] / p[0];
  return raw;
}

void read_orb_slam2(const YamlFile& yaml, CameraFile& file) {
  if (yaml.has("LEFT.K") || yaml.has("LEFT.K.data")) {
    const RawSide left = read_raw_side(yaml, "LEFT."), right = read_raw_side(yaml, "RIGHT.");
    file.rectified = false;
    file.left = left.lens;
    file.right = right.lens;
    file.T_right_left = motion_of_rectified(left.R, right.R, right.base - left.base);
    return;
  }
  file.left = read_orb_lens(yaml, "Camera.", "pinhole");
  file.baseline = yaml.number_above_zero("Camera.bf") / file.left.fx;
}

void read_orb_slam3(const YamlFile& yaml, CameraFile& file) {
  const std::string model = plain_word(yaml.text_or("Camera.type", "PinHole"));
  if (model != "pinhole" && model != "rectified" && model != "kannalabrandt8")
    throw InputError(yaml.place("Camera.type"), "PinHole, Rectified or KannalaBrandt8",
                     in_quotes(yaml.text("Camera.type")));
  for (const char* key : {"Camera.newWidth", "Camera.newHeight"}) {
    if (yaml.has(key)) file.notes.push_back(fmt::format("{} is not followed: images keep their size", key));
  }
  file.left = read_orb_lens(yaml, "Camera1.", model);
  if (const std::string key = matrix_key(yaml, "IMU.T_b_c1"); yaml.has(key))
    file.mountings.push_back({"imu", read_transform(yaml, key)});
  if (yaml.has("Camera2.fx")) {
    file.rectified = false;
    file.right = read_orb_lens(yaml, "Camera2.", model);
    const std::string key = matrix_key(yaml, "Stereo.T_c1_c2");
    file.T_right_left = read_transform(yaml, key).inverse();
    file.place = yaml.place(key);
  } else if (yaml.has("Stereo.b")) {
    file.baseline = yaml.number_above_zero("Stereo.b");
  }
}

CameraFile read_orb_slam(const YamlFile& yaml) {
  CameraFile file;
  file.place = yaml.place(yaml.has("Camera1.fx") ? "Camera1.fx" : "Camera.fx");
  const std::string depth = yaml.has("RGBD.DepthMapFactor") ? "RGBD.DepthMapFactor" : "DepthMapFactor";
  if (yaml.has(depth)) {
    file.sensor = Sensor::rgbd;
    file.depth_factor = yaml.number_above_zero(depth);
  }
  yaml.has("Camera1.fx") ? read_orb_slam3(yaml, file) : read_orb_slam2(yaml, file);
  if (file.sensor == Sensor::rgbd) {
    if (!(file.baseline > 0.0)) file.baseline = kNominalBaseline;
  } else if (file.rectified) {
    if (!(file.baseline > 0.0))
      throw InputError(file.place, "Camera.bf, Stereo.b, Camera2 or DepthMapFactor: a stereo or RGB-D camera",
                       "one camera without depth");
    if (!file.left.distortion.empty())
      throw InputError(file.place, "no distortion of rectified images", "coefficients");
  }
  if (yaml.has("Camera.fps")) file.frame_rate = yaml.number_above_zero("Camera.fps");
  return file;
}

}  // namespace

const CalibrationDialect kOrbSlam = {"ORB-SLAM's settings", is_orb_slam, read_orb_slam};

}  // namespace penumbra::slam
