#include "slam/sources/calibration/camera_keys.h"

#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "nn/base/error.h"
#include "slam/sources/calibration/known_keys.h"
#include "slam/sources/calibration/yaml_words.h"

namespace penumbra::slam {

namespace {

const std::vector<KnownKey>& camera_keys() {
  static const std::vector<KnownKey> keys = [] {
    // Of one lens: at the top, or under left: and right:.
    const KnownKey lens[] = {
        {"fx", {"fu", "focal_length_x"}},
        {"fy", {"fv", "focal_length_y"}},
        {"cx", {"cu", "principal_point_x"}},
        {"cy", {"cv", "principal_point_y"}},
        {"intrinsics", {"intrinsic", "intrinsic_parameters"}},
        {"camera_matrix", {"K", "intrinsic_matrix"}},
        {"width", {"image_width", "img_width"}},
        {"height", {"image_height", "img_height"}},
        {"resolution", {"image_size", "img_size", "size"}},
        {"camera_model", {"camera_type", "projection_model"}},
        {"distortion_model", {"distortion_type", "dist_model"}},
        {"distortion",
         {"distortion_coefficients", "distortion_coeffs", "distortion_coefs", "distortion_parameters",
          "distortion_params", "dist_coeffs", "dist_coefs", "dist_coefficients", "dist", "D"}},
        {"k1", {}},
        {"k2", {}},
        {"k3", {}},
        {"k4", {}},
        {"p1", {"r1"}},
        {"p2", {"r2"}},
    };
    std::vector<KnownKey> keys = {
        {"sensor", {"sensor_type"}},
        {"rectified", {"is_rectified"}},
        {"baseline", {"stereo_baseline", "baseline_m"}},
        {"bf", {"camera_bf", "baseline_times_fx"}},
        {"rate", {"fps", "frame_rate", "framerate", "camera_hz", "camera_fps", "rate_hz", "hz", "frequency"}},
        {"colour", {"color"}},
        {"depth_factor", {"depth_map_factor", "depthmapfactor", "depthmap_factor", "depth_units_per_metre"}},
        {"depth_scale", {}},
        {"T_right_left", {"T_cam1_cam0", "T_cn_cnm1", "T_rl"}},
        {"T_left_right", {"T_cam0_cam1", "T_lr"}},
        {"T_body_left", {"T_body_camera", "T_body_cam0"}},
        {"T_left_body", {"T_camera_body", "T_cam0_body"}},
        {"body", {"body_frame"}},
        {"comment", {"description", "name", "camera_name", "camera", "serial", "serial_number", "date"}},
    };
    for (const KnownKey& key : lens) keys.push_back(key);
    for (const char* side : {"left", "right"}) {
      for (const KnownKey& key : lens) {
        KnownKey of_side{std::string(side) + "." + key.name, {}};
        for (const std::string_view spelling : key.spellings) {
          static std::deque<std::string> names;  // that the views look at
          of_side.spellings.push_back(names.emplace_back(std::string(side) + "." + std::string(spelling)));
        }
        keys.push_back(std::move(of_side));
      }
    }
    return keys;
  }();
  return keys;
}

// Lengths are in metres; keys that name another unit would be wrong by its factor.
void refuse_other_units(const YamlFile& yaml) {
  constexpr struct {
    std::string_view ending, name;
    double metres;
  } kUnits[] = {{"_mm", "millimetres", 1e-3}, {"_cm", "centimetres", 1e-2}, {"_inch", "inches", 0.0254}};
  for (const std::string& key : yaml.keys()) {
    for (const auto& [ending, name, metres] : kUnits) {
      if (!key.ends_with(ending) || !plain_word(key).ends_with(plain_word(fmt::format("baseline{}", ending))))
        continue;
      throw InputError(yaml.place(key),
                       fmt::format("metres, 'baseline: {:g}'", yaml.number_above_zero(key) * metres),
                       fmt::format("{}", name));
    }
  }
}

}  // namespace

void use_camera_keys(YamlFile& yaml) {
  refuse_other_units(yaml);
  use_known_keys(yaml, camera_keys());
}

}  // namespace penumbra::slam
