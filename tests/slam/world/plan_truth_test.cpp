#include "slam/world/plan_truth.h"

#include <gtest/gtest.h>

#include "slam/world/ray_caster.h"
#include "slam/world/street_sequence.h"

namespace penumbra::slam::synthetic {
namespace {

Trajectory looking_along_z(double x, double z, double heading = 0.0) {
  SE3 T;
  T.rotation = rotation_of(heading);
  T.translation = {x, -1.65, z};
  return {{0.0, T}};
}

std::uint8_t cell_at(const OccupancyGrid& plan, double x, double y) {
  const int column = static_cast<int>(std::floor((x - plan.origin.x()) / plan.cell));
  const int row = plan.cells.height() - 1 - static_cast<int>(std::floor((y - plan.origin.y()) / plan.cell));
  return plan.cells.at(column, row);
}

TEST(PlanTruth, CutsBodiesAtTheHeightsThatBlock) {
  World world;
  add_object(world, {make_box({-0.49F, -1.0F, -0.24F}, {0.49F, 0.0F, 0.24F})}).pose = {{2.0, 5.0}, 0.0};
  add_object(world, {make_box({-0.5F, -0.2F, -0.25F}, {0.5F, 0.0F, 0.25F})}).pose = {{-2.0, 5.0},
                                                                                     0.0};  // a kerb
  add_object(world, {make_box({-0.5F, -4.0F, -0.25F}, {0.5F, -2.0F, 0.25F})}).pose = {{0.0, 8.0},
                                                                                      0.0};  // a roof
  Object& passing = add_object(world, {make_box({-0.5F, -1.0F, -0.25F}, {0.5F, 0.0F, 0.25F})});
  passing.pose = {{0.0, 3.0}, 0.0};
  passing.motion.moves = true;
  passing.motion.placement = [](double) { return SE3{Eigen::Matrix3d::Identity(), {0.0, 0.0, 3.0}}; };
  const OccupancySettings settings{.cell = 0.1, .lowest = 0.3, .highest = 1.8};
  const OccupancyGrid plan = true_plan(world, looking_along_z(0.0, 0.0), settings, 10.0);
  // x ahead is the world's z, y to the left its -x.
  EXPECT_EQ(cell_at(plan, 5.0, -2.0), OccupancyGrid::kBlocked);
  EXPECT_EQ(cell_at(plan, 5.2, -2.45), OccupancyGrid::kBlocked);
  EXPECT_EQ(cell_at(plan, 5.35, -2.0), OccupancyGrid::kFree);
  EXPECT_EQ(cell_at(plan, 5.0, -2.65), OccupancyGrid::kFree);
  for (const auto& [x, y] : {std::pair{5.0, 2.0}, {8.0, 0.0}, {3.0, 0.0}})
    EXPECT_EQ(cell_at(plan, x, y), OccupancyGrid::kFree) << x << ' ' << y;
  EXPECT_EQ(cell_at(plan, 9.0, 9.0), OccupancyGrid::kUnknown);
  EXPECT_EQ(plan.count(OccupancyGrid::kBlocked), 10 * 6);

  // From another place and heading the same box lies elsewhere: the camera looks along the world's x.
  const OccupancyGrid turned = true_plan(world, looking_along_z(0.0, 5.0, std::acos(0.0)), settings, 10.0);
  EXPECT_EQ(cell_at(turned, 2.0, 0.0), OccupancyGrid::kBlocked);
}

// What a camera high above the street sees must agree: ground, or the top of something low that stands there.
TEST(PlanTruth, OfAStreetIsWhatIsSeenFromAbove) {
  const StreetSequence street({.frames = 5, .seed = 9});
  const OccupancyGrid plan = true_plan(street.world(), street.poses());
  RayCaster caster(street.world());
  const StereoCamera camera{
      .fx = 2000.0, .fy = 2000.0, .cx = 299.5, .cy = 299.5, .width = 600, .height = 600};
  SE3 T_wc;  // it looks down
  T_wc.rotation.col(1) = -Eigen::Vector3d::UnitZ();
  T_wc.rotation.col(2) = Eigen::Vector3d::UnitY();
  T_wc.translation = street.poses().front().T_wc.translation;
  T_wc.translation.y() = -200.0;
  RenderedView view;
  view.wants_objects = true;
  caster.render(camera, T_wc, 0.0, view);
  int ground = 0, wrong = 0, standing = 0, missing = 0;
  for (int v = 0; v < camera.height; v += 3) {
    for (int u = 0; u < camera.width; u += 3) {
      const auto depth = static_cast<double>(view.depth.at(u, v));
      const Eigen::Vector3d p = plan.T_plan_world * (T_wc * camera.back_project(u, v, depth));
      const std::uint8_t cell = cell_at(plan, p.x(), p.y());
      if (cell == OccupancyGrid::kUnknown) continue;
      // Cells at a rim are blocked in part: those around count.
      int around = 0, free = 0;
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {0, 0}}) {
        const std::uint8_t there = cell_at(plan, p.x() + dx * plan.cell, p.y() + dy * plan.cell);
        around += there == OccupancyGrid::kBlocked;
        free += there == OccupancyGrid::kFree;
      }
      const std::int32_t object = view.object.at(u, v);
      if (std::abs(p.z()) < 0.01) {
        ++ground;
        wrong += around == 5;
      } else if (p.z() > 0.4 && p.z() < 1.7 && object >= 0 &&
                 !street.world().objects[static_cast<std::size_t>(object)].motion.moves) {
        ++standing;
        missing += free == 5;
      }
    }
  }
  EXPECT_GT(ground, 5000);
  EXPECT_LE(wrong, 5);  // in gaps narrower than a cell
  EXPECT_GT(standing, 100);
  EXPECT_EQ(missing, 0);
}

}  // namespace
}  // namespace penumbra::slam::synthetic
