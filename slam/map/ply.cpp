#include "slam/map/ply.h"

#include <fmt/core.h>

#include <charconv>
#include <cstring>
#include <shared_mutex>
#include <string>
#include <string_view>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/map/point_uncertainty.h"

namespace penumbra::slam {

namespace {

constexpr std::string_view kBegin = "ply\nformat binary_little_endian 1.0\n";
constexpr std::string_view kCount = "element vertex ";
constexpr std::string_view kEnd =
    "property float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
constexpr std::size_t kVertexBytes = 3 * sizeof(float) + 3;

PlyVertex vertex(const Eigen::Vector3d& position, std::array<std::uint8_t, 3> bgr) {
  const Eigen::Vector3f p = position.cast<float>();
  return {{p.x(), p.y(), p.z()}, {bgr[2], bgr[1], bgr[0]}};
}

}  // namespace

PointCloud point_cloud_of(const Map& map) {
  const std::shared_lock lock(map.mutex());
  PointCloud cloud;
  cloud.vertices.reserve(map.points().size() + map.keyframes().size());
  for (const auto& point : map.points()) {
    if (point->erased) continue;
    if (is_mostly_uncertain(*point, map.camera(), map.scales())) {
      ++cloud.left_out;
    } else {
      cloud.vertices.push_back(vertex(point->position, point->colour));
    }
  }
  for (const KeyFrame* keyframe : map.keyframes()) {
    cloud.vertices.push_back(vertex(camera_centre(keyframe->T_cw), {0, 0, 255}));
    ++cloud.keyframes;
  }
  return cloud;
}

void write_ply(const std::filesystem::path& path, const PointCloud& cloud) {
  std::string text =
      fmt::format("{}comment Penumbra map: points, then {} keyframe positions in red\n{}{}\n{}", kBegin,
                  cloud.keyframes, kCount, cloud.vertices.size(), kEnd);
  text.reserve(text.size() + kVertexBytes * cloud.vertices.size());
  for (const PlyVertex& v : cloud.vertices) {
    text.append(reinterpret_cast<const char*>(v.position.data()), 3 * sizeof(float));
    text.append(reinterpret_cast<const char*>(v.colour.data()), 3);
  }
  nn::write_file(path, text);
}

void write_pcd(const std::filesystem::path& path, const std::vector<PlyVertex>& vertices) {
  std::string text = fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F "
      "F\n"
      "COUNT 1 1 1 1\nWIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
      vertices.size(), vertices.size());
  text.reserve(text.size() + 16 * vertices.size());
  for (const PlyVertex& v : vertices) {
    const auto rgb = static_cast<std::uint32_t>(v.colour[0] << 16 | v.colour[1] << 8 | v.colour[2]);
    text.append(reinterpret_cast<const char*>(v.position.data()), 3 * sizeof(float));
    text.append(reinterpret_cast<const char*>(&rgb), sizeof(rgb));
  }
  nn::write_file(path, text);
}

std::vector<PlyVertex> read_ply(const std::filesystem::path& path) {
  const std::string bytes = nn::read_file(path, "a point cloud that Penumbra wrote");
  const std::string_view view = bytes;
  const std::size_t at = view.find(kCount), end = view.find(kEnd);
  std::size_t count = 0;
  if (view.substr(0, kBegin.size()) != kBegin || at == view.npos || end == view.npos || at > end) {
    throw InputError(path.string(), "a point cloud that Penumbra wrote", "another header");
  }
  const char* digits = bytes.data() + at + kCount.size();
  const auto [stop, error] = std::from_chars(digits, bytes.data() + end, count);
  const std::string_view body = view.substr(end + kEnd.size());
  if (error != std::errc() || *stop != '\n' || body.size() / kVertexBytes != count ||
      body.size() % kVertexBytes != 0) {
    throw InputError(path.string(),
                     fmt::format("vertices of {} bytes, as many as the header says", kVertexBytes),
                     fmt::format("{} bytes", body.size()));
  }
  std::vector<PlyVertex> vertices(count);
  for (std::size_t i = 0; i < count; ++i) {
    const char* vertex = body.data() + i * kVertexBytes;
    std::memcpy(vertices[i].position.data(), vertex, 3 * sizeof(float));
    std::memcpy(vertices[i].colour.data(), vertex + 3 * sizeof(float), 3);
  }
  return vertices;
}

}  // namespace penumbra::slam
