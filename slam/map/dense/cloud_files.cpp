#include "slam/map/dense/cloud_files.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

#include "nn/base/error.h"
#include "nn/base/file.h"

namespace penumbra::slam {

namespace {

static_assert(std::endian::native == std::endian::little, "both formats are written as the memory has them");

constexpr std::string_view kBegin =
    "ply\nformat binary_little_endian 1.0\ncomment Penumbra dense map, metres\n";
constexpr std::string_view kClass = "comment class ", kCount = "element vertex ";
constexpr std::string_view kEnd =
    "property float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
    "property uchar blue\nproperty uchar class\nend_header\n";
constexpr std::size_t kVertexBytes = 3 * sizeof(float) + 4;

// Red, green, blue.
std::array<std::uint8_t, 3> rgb_of(const Voxel& voxel) {
  const auto byte = [](float value) { return static_cast<std::uint8_t>(std::lround(value)); };
  return {byte(voxel.colour[2]), byte(voxel.colour[1]), byte(voxel.colour[0])};
}

template <typename Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

void write_dense_ply(const std::filesystem::path& path, const VoxelGrid& grid,
                     const std::vector<std::string>& classes) {
  std::string bytes(kBegin);
  for (std::size_t i = 1; i < classes.size(); ++i) bytes += fmt::format("{}{} {}\n", kClass, i, classes[i]);
  bytes += fmt::format("{}{}\n{}", kCount, grid.voxels().size(), kEnd);
  bytes.reserve(bytes.size() + kVertexBytes * grid.voxels().size());
  for (const Voxel& voxel : grid.voxels()) {
    append(bytes, voxel.place);
    append(bytes, rgb_of(voxel));
    append(bytes, static_cast<std::uint8_t>(voxel.class_id));
  }
  nn::write_file(path, bytes);
}

void write_pcd(const std::filesystem::path& path, const VoxelGrid& grid) {
  const std::size_t count = grid.voxels().size();
  std::string bytes = fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb label\nSIZE 4 4 4 4 4\n"
      "TYPE F F F F U\nCOUNT 1 1 1 1 1\nWIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA "
      "binary\n",
      count, count);
  bytes.reserve(bytes.size() + 20 * count);
  for (const Voxel& voxel : grid.voxels()) {
    const std::array<std::uint8_t, 3> rgb = rgb_of(voxel);
    append(bytes, voxel.place);
    append(bytes, static_cast<std::uint32_t>(rgb[0] << 16 | rgb[1] << 8 | rgb[2]));
    append(bytes, static_cast<std::uint32_t>(voxel.class_id));
  }
  nn::write_file(path, bytes);
}

DenseCloud read_dense_ply(const std::filesystem::path& path) {
  const std::string bytes = nn::read_file(path, "a dense map that Penumbra wrote");
  std::string_view rest = bytes;
  const auto refuse = [&] {
    return InputError(path.string(), "a dense map that Penumbra wrote", "another header");
  };
  if (rest.substr(0, kBegin.size()) != kBegin) throw refuse();
  rest.remove_prefix(kBegin.size());
  DenseCloud cloud;
  cloud.classes.emplace_back();
  while (rest.substr(0, kClass.size()) == kClass) {  // "comment class N NAME"
    const std::string_view line = rest.substr(0, rest.find('\n'));
    const std::size_t name = line.find(' ', kClass.size());
    if (name == line.npos || line.size() == rest.size()) throw refuse();
    cloud.classes.emplace_back(line.substr(name + 1));
    rest.remove_prefix(line.size() + 1);
  }
  std::size_t count = 0;
  const std::size_t end = rest.find(kEnd);
  if (rest.substr(0, kCount.size()) != kCount || end == rest.npos) throw refuse();
  const auto [stop, error] = std::from_chars(rest.data() + kCount.size(), rest.data() + end, count);
  if (error != std::errc() || *stop != '\n') throw refuse();
  rest.remove_prefix(end + kEnd.size());
  if (rest.size() / kVertexBytes != count || rest.size() % kVertexBytes != 0) {
    throw InputError(path.string(), fmt::format("{} vertices of {} bytes", count, kVertexBytes),
                     fmt::format("{} bytes", rest.size()));
  }
  cloud.places.resize(count);
  cloud.colours.resize(count);
  cloud.labels.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const char* vertex = rest.data() + i * kVertexBytes;
    std::memcpy(cloud.places[i].data(), vertex, 3 * sizeof(float));
    std::memcpy(cloud.colours[i].data(), vertex + 3 * sizeof(float), 3);
    cloud.labels[i] = static_cast<std::uint8_t>(vertex[kVertexBytes - 1]);
  }
  return cloud;
}

}  // namespace penumbra::slam
