#include "slam/world/plan_truth.h"

#include <algorithm>
#include <cmath>

namespace penumbra::slam::synthetic {

namespace {

// Cells of the plan that may lie below the corners of a box: first and end.
struct CellRange {
  int first_x, first_y, end_x, end_y;
};

class PlanDrawing {
 public:
  PlanDrawing(const World& world, OccupancyGrid& grid, const OccupancySettings& settings)
      : world_(world), grid_(grid), settings_(settings), T_world_plan_(grid.T_plan_world.inverse()) {}

  void draw(const Object& object) {
    const SE3 T_object_world = placement_at(world_, object, 0.0).inverse();
    const CellRange range = range_of(object, T_object_world);
    for (int y = range.first_y; y < range.end_y; ++y) {
      for (int x = range.first_x; x < range.end_x; ++x) {
        std::uint8_t& cell = grid_.cells.at(x, y);
        for (int i = 0; i < kLines * kLines && cell != OccupancyGrid::kBlocked; ++i) {
          const double right = ((i % kLines) - kLines / 2) / static_cast<double>(kLines);
          const double down = ((i / kLines) - kLines / 2) / static_cast<double>(kLines);
          const std::uint8_t kind = kind_at(object, T_object_world, x + right, y + down);
          if (kind != OccupancyGrid::kFree) cell = kind;
        }
      }
    }
  }

  // The middle of a cell, or a place in between, at a height, world.
  Eigen::Vector3d point(double x, double y, double height) const {
    return T_world_plan_ * Eigen::Vector3d(grid_.origin.x() + (x + 0.5) * grid_.cell,
                                           grid_.origin.y() + (grid_.cells.height() - y - 0.5) * grid_.cell,
                                           height);
  }

 private:
  static constexpr int kLines = 3;  // along each side of a cell: posts are thinner than it

  // What of the object cuts the upright line there.
  std::uint8_t kind_at(const Object& object, const SE3& T_object_world, double x, double y) const {
    const Eigen::Vector3f from = (T_object_world * point(x, y, settings_.lowest)).cast<float>();
    const Eigen::Vector3f to = (T_object_world * point(x, y, settings_.highest)).cast<float>();
    // A millimetre askew, for a ray along the axis of a cylinder never meets it.
    const Eigen::Vector3f up = to - from + Eigen::Vector3f(1e-3F, 0.0F, 1e-3F);
    std::uint8_t kind = OccupancyGrid::kFree;
    for (int i = object.first_body; i < object.first_body + object.body_count; ++i) {
      const Body& body = world_.bodies[static_cast<std::size_t>(i)];
      // What is inside above `lowest`, less what is inside above `highest`.
      if (chord(body, from, up) - chord(body, from + up, up) <= 1e-3F) continue;
      if (!body.ragged) return OccupancyGrid::kBlocked;
      kind = OccupancyGrid::kUnknown;
    }
    return kind;
  }

  CellRange range_of(const Object& object, const SE3& T_object_world) const {
    const SE3 T_plan_object = grid_.T_plan_world * T_object_world.inverse();
    Eigen::Vector2d lower = Eigen::Vector2d::Constant(1e9), upper = -lower;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3f p((corner & 1) != 0 ? object.upper.x() : object.lower.x(),
                              (corner & 2) != 0 ? object.upper.y() : object.lower.y(),
                              (corner & 4) != 0 ? object.upper.z() : object.lower.z());
      const Eigen::Vector2d at = (T_plan_object * p.cast<double>()).head<2>();
      lower = lower.cwiseMin(at);
      upper = upper.cwiseMax(at);
    }
    const auto cell_of = [&](double metres) { return static_cast<int>(std::floor(metres / grid_.cell)); };
    const int width = grid_.cells.width(), height = grid_.cells.height();
    return {std::clamp(cell_of(lower.x() - grid_.origin.x()), 0, width),
            std::clamp(height - 1 - cell_of(upper.y() - grid_.origin.y()), 0, height),
            std::clamp(cell_of(upper.x() - grid_.origin.x()) + 1, 0, width),
            std::clamp(height - cell_of(lower.y() - grid_.origin.y()), 0, height)};
  }

  const World& world_;
  OccupancyGrid& grid_;
  const OccupancySettings& settings_;
  const SE3 T_world_plan_;
};

bool stands(const Object& object) { return !object.motion.moves && !object.motion.placement; }

// An empty plan around the path, free as far as `around`.
OccupancyGrid plan_around(const Trajectory& poses, double cell, double around) {
  OccupancyGrid grid;
  grid.cell = cell;
  grid.T_plan_world = plan_from_world({}, poses.front().T_wc);
  std::vector<Eigen::Vector2d> path;
  Eigen::Vector2d lower = Eigen::Vector2d::Constant(1e9), upper = -lower;
  for (const TimedPose& pose : poses) {
    path.emplace_back((grid.T_plan_world * pose.T_wc.translation).head<2>());
    lower = lower.cwiseMin(path.back());
    upper = upper.cwiseMax(path.back());
  }
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(around);
  const Eigen::Array2d first = ((lower - margin).array() / cell).floor();
  const Eigen::Array2d cells = ((upper + margin).array() / cell).ceil() - first;
  grid.origin = first * cell;
  grid.cells =
      ByteImage::filled(static_cast<int>(cells.x()), static_cast<int>(cells.y()), OccupancyGrid::kUnknown);
  Eigen::Vector2d last = Eigen::Vector2d::Constant(1e9);
  for (const Eigen::Vector2d& at : path) {
    if ((at - last).norm() < 0.1 * around) continue;
    last = at;
    const Eigen::Vector2d middle = (at - grid.origin) / cell;
    const int reach = static_cast<int>(around / cell);
    for (int dy = -reach; dy <= reach; ++dy) {
      const int y = grid.cells.height() - 1 - (static_cast<int>(middle.y()) + dy);
      const int half = static_cast<int>(std::sqrt(static_cast<double>(reach * reach - dy * dy)));
      const int first_x = std::max(0, static_cast<int>(middle.x()) - half);
      const int end_x = std::min(grid.cells.width(), static_cast<int>(middle.x()) + half + 1);
      if (y >= 0 && y < grid.cells.height() && first_x < end_x)
        std::fill(grid.cells.row(y) + first_x, grid.cells.row(y) + end_x, OccupancyGrid::kFree);
    }
  }
  return grid;
}

}  // namespace

OccupancyGrid true_plan(const World& world, const Trajectory& poses, const OccupancySettings& settings,
                        double around) {
  OccupancyGrid grid = plan_around(poses, settings.cell, around);
  PlanDrawing drawing(world, grid, settings);
  for (const Object& object : world.objects) {
    if (stands(object)) drawing.draw(object);
  }
  if (!world.room) return grid;
  for (int y = 0; y < grid.cells.height(); ++y) {
    for (int x = 0; x < grid.cells.width(); ++x) {
      const Eigen::Vector3d p = drawing.point(x, y, 0.0);
      if (p.x() < world.room->lower.x() || p.x() > world.room->upper.x() || p.z() < world.room->lower.z() ||
          p.z() > world.room->upper.z())
        grid.cells.at(x, y) = OccupancyGrid::kBlocked;
    }
  }
  return grid;
}

OccupancyGrid true_plan(const World& world, const Trajectory& poses) {
  return world.room ? true_plan(world, poses, {.cell = 0.05, .lowest = 0.1}, 5.0)
                    : true_plan(world, poses, {.cell = 0.1, .lowest = 0.3}, 30.0);
}

}  // namespace penumbra::slam::synthetic
