#include "slam/datasets/kitti_calibration.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "nn/base/error.h"
#include "nn/io/file.h"
#include "nn/io/number_file.h"

namespace penumbra::slam {

namespace {

constexpr double kSameIntrinsics = 1e-3;  // pixels

// A 3 x 4 projection matrix, row by row, and where it stands.
struct Projection {
  std::string place;
  std::vector<double> values;
};

Projection find_projection(std::string_view text, const std::filesystem::path& path, int camera) {
  const std::string label = fmt::format("P{}:", camera);
  int line = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string_view content = text.substr(start, end - start);
    start = end + 1;
    ++line;
    if (content.substr(0, label.size()) != label) continue;
    content.remove_prefix(label.size());
    Projection projection{fmt::format("{}:{} (P{})", path.string(), line, camera), {}};
    projection.values = nn::parse_numbers(content, projection.place);
    if (projection.values.size() != 12) {
      throw InputError(projection.place, "12 numbers (a 3 x 4 projection matrix)",
                       fmt::format("{} numbers", projection.values.size()));
    }
    return projection;
  }
  throw InputError(path.string(), fmt::format("a line 'P{}:' with 12 numbers", camera), "no such line");
}

}  // namespace

StereoCamera read_kitti_calibration(const std::filesystem::path& path, int left, int right) {
  const std::string text = nn::read_text_file(path, "a KITTI calibration file");
  const Projection P_left = find_projection(text, path, left);
  const Projection P_right = find_projection(text, path, right);

  StereoCamera camera;
  camera.fx = P_left.values[0];
  camera.cx = P_left.values[2];
  camera.fy = P_left.values[5];
  camera.cy = P_left.values[6];
  if (!(camera.fx > 0.0 && camera.fy > 0.0)) {
    throw InputError(P_left.place, "focal lengths > 0", fmt::format("{:g} and {:g}", camera.fx, camera.fy));
  }
  static constexpr struct {
    const char* name;
    std::size_t index;
  } kIntrinsics[] = {{"fx", 0}, {"cx", 2}, {"fy", 5}, {"cy", 6}};
  for (const auto& [name, index] : kIntrinsics) {
    if (std::abs(P_left.values[index] - P_right.values[index]) > kSameIntrinsics) {
      throw InputError(P_right.place, fmt::format("the left camera's {} = {:g}", name, P_left.values[index]),
                       fmt::format("{:g}", P_right.values[index]));
    }
  }
  camera.baseline = (P_left.values[3] - P_right.values[3]) / camera.fx;
  // Two finite offsets may be too far apart for a finite difference.
  if (!(camera.baseline > 0.0 && std::isfinite(camera.baseline))) {
    throw InputError(P_right.place, fmt::format("a camera to the right of camera {} (baseline > 0)", left),
                     fmt::format("a baseline of {:g} m", camera.baseline));
  }
  return camera;
}

}  // namespace penumbra::slam
