#include "slam/map/dense/voxel_grid.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "nn/base/counter_random.h"
#include "nn/base/error.h"

namespace penumbra::slam {
namespace {

SurfaceSample random_point(std::uint32_t seed, std::uint32_t i, float extent) {
  auto next = [&, k = 8 * i]() mutable { return counter_uniform_f32(seed, k++); };
  SurfaceSample point;
  point.place = {extent * next(), extent * next(), extent * next()};
  point.weight = 1.5F + next();
  point.colour = {128.0F + 127.0F * next(), 128.0F + 127.0F * next(), 128.0F + 127.0F * next()};
  point.class_id = static_cast<std::uint16_t>(counter_random(seed, i) % 3);
  return point;
}

TEST(VoxelGrid, HoldsTheWeightedMeansOfItsCells) {
  constexpr double kSize = 0.25;
  struct Sums {
    double weight = 0.0;
    Eigen::Vector3d place = Eigen::Vector3d::Zero(), colour = Eigen::Vector3d::Zero();
    std::map<std::uint32_t, int> views;
  };
  std::map<std::array<long, 3>, Sums> expected;
  VoxelGrid grid(kSize);
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const SurfaceSample point = random_point(3, i, 2.0F);
    const std::uint32_t view = 1 + i / 1000;
    grid.add(point, view);
    std::array<long, 3> cell{};
    for (int axis = 0; axis < 3; ++axis)
      cell[std::size_t(axis)] = std::lround(std::floor(point.place[axis] / kSize));
    Sums& sums = expected[cell];
    sums.weight += point.weight;
    sums.place += point.weight * point.place.cast<double>();
    sums.colour += point.weight * point.colour.cast<double>();
    ++sums.views[view];
  }
  ASSERT_EQ(grid.voxels().size(), expected.size());
  for (const auto& [cell, sums] : expected) {
    const Eigen::Vector3f middle =
        kSize * (Eigen::Vector3f(float(cell[0]), float(cell[1]), float(cell[2])).array() + 0.5F);
    const Voxel* voxel = grid.find(middle);
    ASSERT_NE(voxel, nullptr);
    EXPECT_NEAR(voxel->weight, sums.weight, 1e-3 * sums.weight);
    EXPECT_NEAR((voxel->place.cast<double>() - sums.place / sums.weight).norm(), 0.0, 1e-5);
    EXPECT_NEAR((voxel->colour.cast<double>() - sums.colour / sums.weight).norm(), 0.0, 1e-2);
    EXPECT_EQ(voxel->views, sums.views.size());
  }
}

TEST(VoxelGrid, GivesTheClassOfTheMajority) {
  VoxelGrid grid(1.0);
  SurfaceSample point;
  point.place = Eigen::Vector3f::Constant(0.5F);
  point.colour.setZero();
  for (const int label : {4, 7, 7, 4, 7, 2, 7, 7}) {  // five of eight
    point.class_id = static_cast<std::uint16_t>(label);
    grid.add(point, 1);
  }
  EXPECT_EQ(grid.voxels().front().class_id, 7);
}

TEST(VoxelGrid, LeavesOutWhatIsNowhere) {
  VoxelGrid grid(0.01);
  SurfaceSample point;
  point.colour.setZero();
  for (const float place :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e5F}) {
    point.place = {0.0F, place, 0.0F};
    grid.add(point, 1);
    EXPECT_EQ(grid.find(point.place), nullptr);
  }
  EXPECT_TRUE(grid.voxels().empty());
  EXPECT_THROW(VoxelGrid(0.0), UsageError);
  EXPECT_THROW(VoxelGrid(std::nan("")), UsageError);
}

TEST(VoxelGrid, FindsTheOthersWhenSomeAreRemoved) {
  VoxelGrid grid(0.1);
  for (std::uint32_t i = 0; i < 5000; ++i) grid.add(random_point(5, i, 1.0F), 1);
  const std::vector<Voxel> before = grid.voxels();
  grid.remove_if([](const Voxel& voxel) { return voxel.place.x() > 0.0F; });
  for (const Voxel& voxel : before) EXPECT_EQ(grid.find(voxel.place) != nullptr, voxel.place.x() <= 0.0F);
}

}  // namespace
}  // namespace penumbra::slam
