#include "slam/map/ply.h"

#include <fmt/core.h>

#include <string>

#include "nn/io/file.h"

namespace penumbra::slam {

namespace {

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
  const std::string header = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment Penumbra map: points, then {} keyframe positions in "
      "red\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
      map.keyframes().size(), count);

  nn::write_file(path, header + vertices);
}

}  // namespace penumbra::slam
