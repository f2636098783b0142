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

void append_vertex(std::string& bytes, const Eigen::Vector3d& position, std::array<std::uint8_t, 3> bgr) {
  const Eigen::Vector3f p = position.cast<float>();
  bytes.append(reinterpret_cast<const char*>(p.data()), 3 * sizeof(float));
  for (const std::size_t channel : {2U, 1U, 0U}) bytes.push_back(static_cast<char>(bgr[channel]));
}

}  // namespace

void write_ply(const std::filesystem::path& path, const Map& map) {
  std::string vertices;
  std::size_t count = 0;
  for (const auto& point : map.points()) {
    if (point->erased) continue;
    append_vertex(vertices, point->position, point->colour);
    ++count;
  }
  for (const KeyFrame* keyframe : map.keyframes()) {
    append_vertex(vertices, keyframe->T_cw.inverse().translation, {0, 0, 255});
    ++count;
  }
  const std::string header =
      fmt::format("{}comment Penumbra map: points, then {} keyframe positions in red\n{}{}\n{}", kBegin,
                  map.keyframes().size(), kCount, count, kEnd);

  nn::write_file(path, header + vertices);
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
