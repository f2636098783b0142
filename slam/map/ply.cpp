#include "slam/map/ply.h"

#include <fmt/core.h>

#include <charconv>
#include <cstring>
#include <string>
#include <string_view>

#include "nn/base/error.h"
#include "nn/io/file.h"

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

std::vector<PlyVertex> vertices_of(const Map& map) {
  std::vector<PlyVertex> vertices;
  vertices.reserve(map.points().size() + map.keyframes().size());
  for (const auto& point : map.points()) {
    if (!point->erased) vertices.push_back(vertex(point->position, point->colour));
  }
  for (const KeyFrame* keyframe : map.keyframes()) {
    vertices.push_back(vertex(keyframe->T_cw.inverse().translation, {0, 0, 255}));
  }
  return vertices;
}

void write_ply(const std::filesystem::path& path, const Map& map) {
  const std::vector<PlyVertex> vertices = vertices_of(map);
  std::string body;
  body.reserve(kVertexBytes * vertices.size());
  for (const PlyVertex& v : vertices) {
    body.append(reinterpret_cast<const char*>(v.position.data()), 3 * sizeof(float));
    body.append(reinterpret_cast<const char*>(v.colour.data()), 3);
  }
  const std::string header =
      fmt::format("{}comment Penumbra map: points, then {} keyframe positions in red\n{}{}\n{}", kBegin,
                  map.keyframes().size(), kCount, vertices.size(), kEnd);

  nn::write_file(path, header + body);
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
