#include "slam/sources/kitti_calibration.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/nearest_word.h"
#include "nn/base/number_file.h"
#include "nn/base/text.h"

namespace penumbra::slam {

namespace {

constexpr double kSameIntrinsics = 1e-3;  // pixels

// What stands behind a label.
struct Labelled {
  std::string place;  // "file:line (label)"
  std::string values;
};

// The lines of the file by their labels. Throws InputError for a label that is not KITTI's, or stands twice.
std::map<std::string, Labelled> read_labelled(const std::filesystem::path& path) {
  static constexpr std::string_view kKnown[] = {"P0",
                                                "P1",
                                                "P2",
                                                "P3",
                                                "Tr",
                                                "Tr_velo_to_cam",
                                                "Tr_imu_to_velo",
                                                "Tr_velo_cam",
                                                "Tr_imu_velo",
                                                "Tr_cam_to_road",
                                                "R0_rect",
                                                "R_rect",
                                                "calib_time",
                                                "corner_dist"};
  std::map<std::string, Labelled> found;
  nn::LineReader reader(path, "a KITTI calibration file");
  while (const std::optional<std::string_view> line = reader.next()) {
    const std::size_t colon = std::min(line->find(':'), line->size());
    const std::string label(line->substr(0, colon));
    if (colon == line->size() || std::find(std::begin(kKnown), std::end(kKnown), label) == std::end(kKnown)) {
      throw InputError(reader.place(),
                       "a line 'P0: ' to 'P3: ' with 12 numbers, or 'Tr: '" + suggestion(label, kKnown),
                       fmt::format("'{}'", printable(*line, 40)));
    }
    Labelled labelled{fmt::format("{} ({})", reader.place(), label), std::string(line->substr(colon + 1))};
    const auto [at, is_new] = found.try_emplace(label, std::move(labelled));
    if (!is_new) throw InputError(reader.place(), "every label once", fmt::format("{} again", label));
  }
  return found;
}

ProjectionRow find_projection(const std::map<std::string, Labelled>& lines, const std::filesystem::path& path,
                              int camera) {
  const auto at = lines.find(fmt::format("P{}", camera));
  if (at == lines.end())
    throw InputError(path.string(), fmt::format("a line 'P{}:' with 12 numbers", camera), "no such line");
  ProjectionRow projection{at->second.place, nn::parse_numbers(at->second.values, at->second.place)};
  if (projection.values.size() != 12) {
    throw InputError(projection.place, "12 numbers (a 3 x 4 projection matrix)",
                     counted(projection.values.size(), "number"));
  }
  return projection;
}

}  // namespace

StereoCamera pair_of(const ProjectionRow& P_left, const ProjectionRow& P_right, int left_number) {
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
    throw InputError(P_right.place,
                     fmt::format("a camera to the right of camera {} (baseline > 0)", left_number),
                     fmt::format("a baseline of {:g} m", camera.baseline));
  }
  return camera;
}

StereoCamera read_kitti_calibration(const std::filesystem::path& path, int left, int right) {
  const std::map<std::string, Labelled> lines = read_labelled(path);
  const ProjectionRow P_left = find_projection(lines, path, left);
  return pair_of(P_left, find_projection(lines, path, right), left);
}

}  // namespace penumbra::slam
