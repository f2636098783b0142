#include "slam/sources/openloris.h"

#include <fmt/core.h>

#include <algorithm>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/number_file.h"
#include "slam/sources/calibration/lens_reader.h"

namespace penumbra::slam {

namespace {

const std::string kCamera = "d400_color_optical_frame";

// The word behind "key:" from `at` on; empty where the key does not come before `end`.
std::string word_behind(const std::string& text, const std::string& key, std::size_t at, std::size_t end) {
  const std::size_t found = text.find(key + ":", at);
  if (found >= end) return {};
  const std::size_t first = text.find_first_not_of(" \"'", found + key.size() + 1);
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_first_of(" \"'\n", first) - first);
}

}  // namespace

CameraFile read_openloris_camera(const std::filesystem::path& sensors_yaml) {
  const YamlFile yaml(sensors_yaml);
  const std::string at = kCamera + ".";
  CameraFile file;
  file.sensor = Sensor::rgbd;
  file.baseline = kNominalBaseline;
  file.depth_factor = 1000.0;
  file.place = sensors_yaml.string();
  set_size(file.left, yaml.number_above_zero(at + "width"), yaml.number_above_zero(at + "height"),
           yaml.place(at + "width"));
  require_pinhole(yaml, at + "model");
  const std::string key = matrix_key(yaml, at + "intrinsics");
  const std::vector<double> numbers = yaml.numbers(key, 4);
  set_intrinsics(file.left, {numbers[0], numbers[2], numbers[1], numbers[3]}, yaml.place(key));
  const std::string distortion = matrix_key(yaml, at + "distortion_coefficients");
  if (!yaml.has(distortion)) return file;
  std::vector<double> coefficients = yaml.numbers(distortion);
  if (std::all_of(coefficients.begin(), coefficients.end(), [](double c) { return c == 0.0; })) return file;
  set_lens_model(file.left, yaml.text_or(at + "distortion_model", "radial-tangential"), coefficients,
                 yaml.place(distortion));
  return file;
}

std::optional<SE3> read_openloris_mounting(const std::filesystem::path& trans_matrix_yaml) {
  const std::string text = nn::read_text_file(trans_matrix_yaml, "OpenLORIS' trans_matrix.yaml");
  const std::string kParent = "parent_frame";
  for (std::size_t at = text.find(kParent); at != std::string::npos;) {
    const std::size_t next = text.find(kParent, at + 1);
    const std::size_t end = std::min(next, text.size());
    const std::size_t open = text.find('[', at), close = text.find(']', at);
    const bool is_it = word_behind(text, kParent, at, end) == "base_link" &&
                       word_behind(text, "child_frame", at, end) == kCamera && open < close && close < end;
    if (is_it) {
      std::string rows = text.substr(open + 1, close - open - 1);
      std::replace_if(
          rows.begin(), rows.end(), [](char c) { return c == ',' || c == '\n'; }, ' ');
      const std::string place =
          fmt::format("{}:{}", trans_matrix_yaml.string(),
                      1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(open), '\n'));
      return rigid_motion(nn::parse_numbers(rows, place), place);
    }
    at = next;
  }
  return std::nullopt;
}

}  // namespace penumbra::slam
