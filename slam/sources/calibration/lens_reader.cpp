#include "slam/sources/calibration/lens_reader.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/image/image_container.h"
#include "slam/sources/calibration/yaml_words.h"

namespace penumbra::slam {

namespace {

constexpr std::size_t kFewestRational = 8;  // k1 k2 p1 p2 k3 to k6

}  // namespace

std::string one_of(const YamlFile& yaml, std::initializer_list<std::string> keys) {
  std::string found;
  for (const std::string& key : keys) {
    if (!yaml.has(key)) continue;
    if (!found.empty())
      throw InputError(yaml.place(key), "one of two ways to say it", yaml.place(found) + " as well");
    found = key;
  }
  return found.empty() ? *keys.begin() : found;
}

std::string matrix_key(const YamlFile& yaml, const std::string& key) {
  return yaml.has_value(key + ".data") ? key + ".data" : key;
}

const char* lens_model_name(LensModel model, std::size_t coefficients) {
  if (model == LensModel::equidistant) return "equidistant";
  return coefficients >= kFewestRational ? "rational" : "radial-tangential";
}

void set_lens_model(LensCamera& camera, std::string_view name, const std::vector<double>& distortion,
                    const std::string& place) {
  std::size_t fewest = 0, most = 0;
  bool is_rational = false;
  const std::string model = plain_word(name);
  const auto is_one_of = [&](std::initializer_list<std::string_view> names) {
    return std::find(names.begin(), names.end(), model) != names.end();
  };
  if (is_one_of({"radialtangential", "radtan", "plumbbob", "brownconrady"})) {
    camera.model = LensModel::radial_tangential;
    fewest = 4;
    most = 5;
  } else if (is_one_of({"rationalpolynomial", "rational"})) {
    camera.model = LensModel::radial_tangential;
    fewest = kFewestRational;
    most = 14;
    is_rational = true;
  } else if (is_one_of({"equidistant", "equi", "fisheye", "kannalabrandt", "kannalabrandt4"})) {
    camera.model = LensModel::equidistant;
    fewest = most = 4;
  } else if (model != "none") {
    throw InputError(place, "a distortion model: radial-tangential, rational, equidistant or none",
                     fmt::format("'{}'", printable(name, 40)));
  }
  const std::size_t n = distortion.size();
  // The rational model's come by the piece: 8, with a thin prism 12, with a tilted sensor 14.
  const bool fits = is_rational ? n == 8 || n == 12 || n == 14 : n >= fewest && n <= most;
  if (!fits) {
    throw InputError(place,
                     is_rational ? fmt::format("8, 12 or 14 coefficients of the model {}", name)
                                 : fmt::format("{} to {} coefficients of the model {}", fewest, most, name),
                     fmt::format("{}", n));
  }
  camera.distortion = distortion;
}

void require_pinhole(const YamlFile& yaml, const std::string& key) {
  const std::string model = yaml.text_or(key, "pinhole");
  if (plain_word(model) == "pinhole") return;
  throw InputError(yaml.place(key), "pinhole (fisheye lenses, too, with distortion_model: equidistant)",
                   in_quotes(model));
}

namespace {

int pixels_of(double value, const std::string& place) {
  if (!(value >= 1.0 && value <= 65535.0) || value != std::floor(value)) {
    throw InputError(place, "a whole number of pixels", fmt::format("{:g}", value));
  }
  return static_cast<int>(value);
}

}  // namespace

void set_size(LensCamera& camera, double width, double height, const std::string& place) {
  camera.width = pixels_of(width, place);
  camera.height = pixels_of(height, place);
  if (static_cast<long>(camera.width) * camera.height > nn::kMaxImagePixels) {
    throw InputError(place, "an image that can be", fmt::format("{} x {}", camera.width, camera.height));
  }
}

void set_intrinsics(LensCamera& camera, const std::vector<double>& v, const std::string& place) {
  if (v.size() != 4 && v.size() != 9)
    throw InputError(place, "fx fy cx cy, or a camera matrix of 9 numbers", counted(v.size(), "number"));
  const bool is_matrix = v.size() == 9;
  if (is_matrix && (v[1] != 0.0 || v[3] != 0.0 || v[6] != 0.0 || v[7] != 0.0 || v[8] != 1.0)) {
    throw InputError(place, "fx 0 cx, 0 fy cy, 0 0 1", "other zeros and ones");
  }
  camera.fx = v[0];
  camera.fy = v[is_matrix ? 4 : 1];
  camera.cx = v[2];
  camera.cy = v[is_matrix ? 5 : 3];
  if (!(camera.fx > 0.0 && camera.fy > 0.0)) {
    throw InputError(place, "focal lengths > 0", fmt::format("{:g} and {:g}", camera.fx, camera.fy));
  }
}

namespace {

// Width and height under `prefix`, or those at the top, which hold for both lenses.
void read_size(const YamlFile& yaml, const std::string& prefix, LensCamera& lens) {
  const bool is_here =
      yaml.has(prefix + "width") || yaml.has(prefix + "height") || yaml.has(prefix + "resolution");
  const std::string& at = is_here ? prefix : "";
  if (yaml.has(at + "resolution")) {
    if (yaml.has(at + "width") || yaml.has(at + "height")) {
      throw InputError(yaml.place(at + "resolution"), "either width and height or a resolution", "both");
    }
    const std::vector<double> size = yaml.numbers(at + "resolution", 2);
    set_size(lens, size[0], size[1], yaml.place(at + "resolution"));
  } else if (yaml.has(at + "width") || yaml.has(at + "height")) {
    if (!yaml.has(at + "width") || !yaml.has(at + "height"))
      throw InputError(yaml.place(at + "width"), "width and height", "one of them");
    set_size(lens, yaml.number_above_zero(at + "width"), yaml.number_above_zero(at + "height"),
             yaml.place(at + "width"));
  }
}

void read_intrinsics(const YamlFile& yaml, const std::string& prefix, LensCamera& lens) {
  const std::string key = one_of(yaml, {prefix + "fx", prefix + "intrinsics", prefix + "camera_matrix"});
  if (key == prefix + "fx") {
    lens.fx = yaml.number_above_zero(prefix + "fx");
    lens.fy = yaml.number_above_zero(prefix + "fy");
    lens.cx = yaml.number(prefix + "cx");
    lens.cy = yaml.number(prefix + "cy");
    return;
  }
  for (const char* single : {"fy", "cx", "cy"}) one_of(yaml, {key, prefix + single});
  set_intrinsics(lens, yaml.numbers(key, key == prefix + "camera_matrix" ? 9 : 4), yaml.place(key));
}

// The coefficients, as a list or one by one, and the key to blame; none where the file has none.
std::vector<double> read_distortion(const YamlFile& yaml, const std::string& prefix, std::string& key) {
  key = prefix + "distortion";
  const bool has_p = yaml.has(prefix + "p1");
  std::vector<double> coefficients;
  for (const char* name : {"k1", "k2", "p1", "p2", "k3", "k4"}) {
    const std::string single = prefix + name;
    if (!yaml.has(single)) continue;
    if (yaml.has(key)) one_of(yaml, {key, single});
    coefficients.push_back(yaml.number(single));
  }
  if (coefficients.empty()) return yaml.has(key) ? yaml.numbers(key) : coefficients;
  key = prefix + "k1";
  const std::size_t order = has_p ? 4 + (yaml.has(prefix + "k3") ? 1 : 0) : 4;
  const bool complete = coefficients.size() == order && yaml.has(prefix + "k1") && yaml.has(prefix + "k2") &&
                        (has_p ? yaml.has(prefix + "p2") : yaml.has(prefix + "k3"));
  if (!complete) {
    throw InputError(yaml.place(yaml.has(key) ? key : prefix + "k2"), "k1 k2 p1 p2 [k3], or k1 k2 k3 k4",
                     fmt::format("{} of them", coefficients.size()));
  }
  return coefficients;
}

}  // namespace

LensCamera read_lens(const YamlFile& yaml, const std::string& prefix) {
  LensCamera lens;
  read_size(yaml, prefix, lens);
  read_intrinsics(yaml, prefix, lens);
  const std::string model = prefix + "camera_model";
  require_pinhole(yaml, model);
  std::string key;
  const std::vector<double> distortion = read_distortion(yaml, prefix, key);
  const bool undistorted =
      std::all_of(distortion.begin(), distortion.end(), [](double c) { return c == 0.0; });
  if (!distortion.empty() && undistorted) {
    lens.model = LensModel::radial_tangential;
  } else if (yaml.has(key)) {
    // k1 k2 k3 k4 without p1 and p2 are those of a fisheye lens.
    const bool fisheye = key == prefix + "k1" && !yaml.has(prefix + "p1");
    set_lens_model(lens,
                   yaml.text_or(prefix + "distortion_model", fisheye ? "equidistant" : "radial-tangential"),
                   distortion, yaml.place(key));
    if (lens.width == 0) {
      throw InputError(yaml.place(key), "width and height of the images, to undo the distortion", "neither");
    }
  } else if (yaml.has(prefix + "distortion_model") &&
             plain_word(yaml.text(prefix + "distortion_model")) != "none") {
    throw InputError(yaml.place(prefix + "distortion_model"), "the key distortion with its coefficients",
                     "no such key");
  }
  return lens;
}

}  // namespace penumbra::slam
