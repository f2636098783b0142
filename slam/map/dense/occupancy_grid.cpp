#include "slam/map/dense/occupancy_grid.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "nn/base/file.h"
#include "nn/image/image_file.h"
#include "slam/map/dense/plan_file.h"

namespace penumbra::slam {

namespace {

constexpr double kFloorBand = 0.5;  // around the floor, of the height from which on something blocks

// A cell most of whose neighbours are free is free, too: far floor is measured with gaps.
void close_gaps(ByteImage& cells) {
  const ByteImage before = cells.clone();
  constexpr int kMostNeighbours = 5;
  for (int y = 1; y < cells.height() - 1; ++y) {
    for (int x = 1; x < cells.width() - 1; ++x) {
      if (before.at(x, y) != OccupancyGrid::kUnknown) continue;
      int free = 0;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) free += before.at(x + dx, y + dy) == OccupancyGrid::kFree;
      }
      if (free >= kMostNeighbours) cells.at(x, y) = OccupancyGrid::kFree;
    }
  }
}

}  // namespace

SE3 plan_from_world(const FloorPlane& floor, const SE3& first_camera) {
  const Eigen::Vector3d& z = floor.normal;
  const auto level = [&](const Eigen::Vector3d& axis) -> Eigen::Vector3d { return axis - axis.dot(z) * z; };
  Eigen::Vector3d x = level(first_camera.rotation.col(2));
  if (x.norm() < 0.1) x = level(-first_camera.rotation.col(1));
  x.normalize();
  SE3 T;
  T.rotation.row(0) = x.transpose();
  T.rotation.row(1) = z.cross(x).transpose();
  T.rotation.row(2) = z.transpose();
  const Eigen::Vector3d foot = first_camera.translation - floor.height(first_camera.translation) * z;
  T.translation = -(T.rotation * foot);
  return T;
}

int OccupancyGrid::count(std::uint8_t kind) const {
  return static_cast<int>(std::count(cells.row(0), cells.row(0) + cells.elements(), kind));
}

OccupancyGrid occupancy_of(const VoxelGrid& voxels, const FloorPlane& floor, const SE3& first_camera,
                           const OccupancySettings& settings) {
  OccupancyGrid grid;
  grid.cell = settings.cell;
  grid.T_plan_world = plan_from_world(floor, first_camera);
  Eigen::Vector2d lower = Eigen::Vector2d::Constant(1e9), upper = -lower;
  std::vector<Eigen::Vector3d> places;
  places.reserve(voxels.voxels().size());
  for (const Voxel& voxel : voxels.voxels()) {
    places.push_back(grid.T_plan_world * voxel.place.cast<double>());
    lower = lower.cwiseMin(places.back().head<2>());
    upper = upper.cwiseMax(places.back().head<2>());
  }
  if (places.empty()) lower = upper = Eigen::Vector2d::Zero();
  const auto cell_of = [&](double metres) { return static_cast<int>(std::floor(metres / settings.cell)); };
  const int left = cell_of(lower.x()), bottom = cell_of(lower.y());
  const int width = cell_of(upper.x()) - left + 1, height = cell_of(upper.y()) - bottom + 1;
  grid.origin = {left * settings.cell, bottom * settings.cell};
  Image<int> blocking(width, height);
  blocking.fill(0);
  grid.cells = ByteImage::filled(width, height, OccupancyGrid::kUnknown);
  for (const Eigen::Vector3d& p : places) {
    const int x = cell_of(p.x()) - left, y = height - 1 - (cell_of(p.y()) - bottom);
    if (std::abs(p.z()) < kFloorBand * settings.lowest) grid.cells.at(x, y) = OccupancyGrid::kFree;
    blocking.at(x, y) += p.z() >= settings.lowest && p.z() <= settings.highest;
  }
  close_gaps(grid.cells);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (blocking.at(x, y) >= settings.fewest_voxels) grid.cells.at(x, y) = OccupancyGrid::kBlocked;
    }
  }
  return grid;
}

void write_occupancy(const std::filesystem::path& path, const OccupancyGrid& grid) {
  std::filesystem::path image = path, text = path;
  image.replace_extension(".pgm");
  text.replace_extension(".yaml");
  std::string pgm = fmt::format("P5\n{} {}\n255\n", grid.cells.width(), grid.cells.height());
  pgm.append(reinterpret_cast<const char*>(grid.cells.row(0)), grid.cells.elements());
  nn::write_file(image, pgm);
  nn::write_file(text,
                 fmt::format("image: {}\nmode: trinary\nresolution: {:.6g}\norigin: [{:.6g}, {:.6g}, 0.0]\n"
                             "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
                             image.filename().string(), grid.cell, grid.origin.x(), grid.origin.y()));
}

OccupancyGrid read_occupancy(const std::filesystem::path& yaml) {
  const PlanFile file = read_plan_file(yaml);
  OccupancyGrid grid;
  grid.cell = file.cell;
  grid.origin = file.origin;
  const ByteImage image = nn::read_image(yaml.parent_path() / file.image, nn::ImageColour::grey);
  grid.cells.create(image.width(), image.height());
  std::transform(image.data(), image.data() + image.elements(), grid.cells.data(), [&](std::uint8_t level) {
    const double occupancy = (file.negate ? level : 255 - level) / 255.0;
    return occupancy > file.occupied ? OccupancyGrid::kBlocked
           : occupancy < file.free   ? OccupancyGrid::kFree
                                     : OccupancyGrid::kUnknown;
  });
  return grid;
}

}  // namespace penumbra::slam
