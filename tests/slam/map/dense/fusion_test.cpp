#include "slam/map/dense/fusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/image/image_file.h"
#include "slam/map/dense/cloud_files.h"
#include "slam/map/dense/occupancy_grid.h"
#include "tests/support/bytes.h"
#include "tests/support/expect_error.h"
#include "tests/support/room_views.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

using namespace penumbra::test;

TEST(Fusion, PutsSurfacesWhereTheyAre) {
  RoomViews views;
  for (const double x : {-0.1, 0.0, 0.1}) views.add(at(x), false);
  const VoxelGrid grid = fuse(views.posed(), {.voxel = 0.02});
  EXPECT_GT(grid.voxels().size(), 10'000U);
  for (const Voxel& voxel : grid.voxels()) EXPECT_LT(off_surface(voxel), 0.003);
}

TEST(Fusion, ClearsWhatLaterViewsLookThrough) {
  RoomViews views;
  views.add(at(0.0), true);
  const std::size_t with_pillar = fuse(views.posed(), {.voxel = 0.02}).voxels().size();
  const auto on_pillar = [](const VoxelGrid& grid) {
    return std::count_if(grid.voxels().begin(), grid.voxels().end(),
                         [](const Voxel& v) { return off_surface(v) > 0.1; });
  };
  EXPECT_GT(on_pillar(fuse(views.posed(), {.voxel = 0.02})), 200);
  EXPECT_GT(with_pillar, 0U);
  views.add(at(0.05), false);
  views.add(at(-0.05), false);
  // Its foot is too near to the floor behind it to be looked through for certain.
  const VoxelGrid cleared = fuse(views.posed(), {.voxel = 0.02});
  EXPECT_LT(on_pillar(cleared), 40);
  for (const Voxel& voxel : cleared.voxels())
    EXPECT_TRUE(off_surface(voxel) < 0.1 || voxel.place.y() > kAboveFloor - 0.2);
  // What stands there in every view stays.
  RoomViews standing;
  for (const double x : {-0.05, 0.0, 0.05}) standing.add(at(x), true);
  EXPECT_GT(on_pillar(fuse(standing.posed(), {.voxel = 0.02})), 200);
}

TEST(Fusion, LooksThroughAtWhatMoves) {
  // Before the wall stood somebody whom nobody recognised; later the whole view is known to move.
  RoomViews views;
  views.add(at(0.0), true);
  for (const double x : {-0.05, 0.05}) {
    views.add(at(x), false);
    views.kept.back().label.fill(kMoves);
  }
  const VoxelGrid grid = fuse(views.posed(), {.voxel = 0.02});
  for (const Voxel& voxel : grid.voxels())
    EXPECT_TRUE(off_surface(voxel) < 0.1 || voxel.place.y() > kAboveFloor - 0.2);
}

TEST(Fusion, MeasuresNothingFarButLooksThroughAtIt) {
  RoomViews views;
  views.add(at(0.0), true);
  for (const double x : {-0.05, 0.05}) views.add(at(x), false);
  const VoxelGrid grid = fuse(views.posed(), {.voxel = 0.02, .farthest = 2.0});
  EXPECT_GT(grid.voxels().size(), 300U);  // the floor
  for (const Voxel& voxel : grid.voxels()) {
    EXPECT_LE(voxel.place.z(), 2.0F);
    EXPECT_TRUE(off_surface(voxel) < 0.1 || voxel.place.y() > kAboveFloor - 0.2);
  }
}

TEST(Fusion, LeavesOutWhatMoves) {
  RoomViews views;
  views.add(at(0.0), true);
  // The pillar's mask, given at half its size: columns within 0.2 m of the middle at 1.5 m.
  const Rect region{58, 0, 44, 120};
  set_label(views.kept.front(), region, ByteImage::filled(22, 60, 255), kMoves, 2);
  const VoxelGrid grid = fuse(views.posed(), {.voxel = 0.02});
  for (const Voxel& voxel : grid.voxels()) EXPECT_LT(off_surface(voxel), 0.003);
  EXPECT_EQ(views.kept.front().label.at(56, 60), kMoves);
  EXPECT_EQ(views.kept.front().label.at(55, 60), 0);
  // A region that reaches over the border, and one without a mask.
  set_label(views.kept.front(), {-20, -20, 400, 400}, ByteImage::filled(3, 3, 255), 4, 0);
  EXPECT_EQ(views.kept.front().label.at(0, 0), 4);
  EXPECT_EQ(views.kept.front().label.at(80, 60), kMoves);
  set_label(views.kept.front(), {0, 0, 10, 10}, {}, kMoves, 3);
  EXPECT_EQ(views.kept.front().label.at(0, 0), 4);
}

TEST(DenseView, LeavesOutJumpsAndHoles) {
  FloatImage depth = FloatImage::filled(8, 6, 1.0F);
  for (int v = 0; v < 6; ++v) {
    for (int u = 5; u < 8; ++u) depth.at(u, v) = 2.0F;
  }
  depth.at(1, 1) = 0.0F;
  depth.at(0, 5) = std::nanf("");
  const DenseView view = make_dense_view(kRoomCamera, ByteImage::filled(8, 6, 9), depth, 1);
  EXPECT_EQ(view.depth_at(2, 2), 1.0F);  // beside the hole
  EXPECT_EQ(view.depth_at(1, 1), 0.0F);
  EXPECT_EQ(view.depth_at(0, 5), 0.0F);
  EXPECT_EQ(view.depth_at(4, 3), 0.0F);  // at the jump
  EXPECT_EQ(view.depth_at(5, 3), 0.0F);
  EXPECT_EQ(view.depth_at(7, 3), 2.0F);
  const DenseView small =
      make_dense_view(kRoomCamera, ByteImage::filled(7, 5, 9, 3), FloatImage::filled(7, 5, 1.0F), 2);
  EXPECT_EQ(small.depth.size(), (Size{4, 3}));
  EXPECT_EQ(small.camera.fx, kRoomCamera.fx / 2);
}

TEST(DenseView, KnowsTheNearestDepthAroundAPixel) {
  FloatImage depth = FloatImage::filled(9, 9, 2.0F);
  depth.at(4, 4) = 1.95F;
  for (int v = 0; v < 9; ++v) depth.at(7, v) = depth.at(8, v) = 0.0F;
  const DenseView view = make_dense_view(kRoomCamera, ByteImage::filled(9, 9, 9), depth, 1);
  EXPECT_NEAR(nearest_depth(view, 3, 3), 1.95F, 1e-3F);
  EXPECT_EQ(nearest_depth(view, 2, 2), 2.0F);
  EXPECT_EQ(nearest_depth(view, 6, 2), 2.0F);  // six of nine are known
  EXPECT_EQ(nearest_depth(view, 7, 2), 0.0F);
  EXPECT_EQ(nearest_depth(view, 0, 3), 0.0F);
  const FloatImage all = nearest_depths(view);
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 9; ++column)
      EXPECT_EQ(all.at(column, row), nearest_depth(view, column, row));
  }
}

TEST(FloorPlane, IsFoundBelowATiltedCamera) {
  RoomViews views;
  SE3 tilted = at(0.2);
  tilted.rotation = so3_exp({-0.3, 0.0, 0.1});
  views.add(tilted, true);
  const VoxelGrid grid = fuse(views.posed(), {.voxel = 0.02});
  std::vector<Eigen::Vector3f> points;
  for (const Voxel& voxel : grid.voxels()) points.push_back(voxel.place);
  const auto floor = find_floor(points, views.poses);
  ASSERT_TRUE(floor.has_value());
  EXPECT_NEAR((floor->normal - Eigen::Vector3d(0.0, -1.0, 0.0)).norm(), 0.0, 0.005);
  EXPECT_NEAR(floor->height({0.0, 0.0, 0.0}), kAboveFloor, 0.005);
  EXPECT_FALSE(find_floor({}, views.poses).has_value());
  EXPECT_FALSE(find_floor(points, {}).has_value());
  std::erase_if(points, [](const Eigen::Vector3f& p) { return p.y() > kAboveFloor - 0.1; });  // walls alone
  EXPECT_FALSE(find_floor(points, views.poses).has_value());
}

TEST(OccupancyGrid, ShowsFloorAndPillar) {
  RoomViews views;
  for (const double x : {-0.1, 0.0, 0.1}) views.add(at(x), true);
  const VoxelGrid grid = fuse(views.posed(), {.voxel = 0.02});
  const FloorPlane floor{-Eigen::Vector3d::UnitY(), kAboveFloor};
  const OccupancyGrid plan = occupancy_of(grid, floor, at(0.0), {.cell = 0.1});
  // x ahead, y left, from the foot of the first camera.
  const auto cell = [&](double x, double y) {
    const int column = static_cast<int>(std::floor((x - plan.origin.x()) / plan.cell));
    const int row = plan.cells.height() - 1 - static_cast<int>(std::floor((y - plan.origin.y()) / plan.cell));
    return plan.cells.at(column, row);
  };
  EXPECT_EQ(cell(1.52, 0.05), OccupancyGrid::kBlocked);
  EXPECT_EQ(cell(1.52, -0.05), OccupancyGrid::kBlocked);
  EXPECT_EQ(cell(2.5, 0.95), OccupancyGrid::kFree);
  EXPECT_EQ(cell(2.2, 0.0), OccupancyGrid::kUnknown);    // behind the pillar
  EXPECT_EQ(cell(3.02, 0.95), OccupancyGrid::kBlocked);  // the wall

  const TemporaryDirectory folder;
  write_occupancy(folder / "plan", plan);
  const std::string pgm = read_file(folder / "plan.pgm");
  EXPECT_EQ(pgm.substr(0, 3), "P5\n");
  EXPECT_EQ(pgm.size() - pgm.find("255\n") - 4, plan.cells.elements());
  const std::string yaml = read_file(folder / "plan.yaml");
  EXPECT_NE(yaml.find("image: plan.pgm\n"), yaml.npos);
  EXPECT_NE(yaml.find("resolution: 0.1\n"), yaml.npos);
  const OccupancyGrid again = read_occupancy(folder / "plan.yaml");
  EXPECT_EQ(again.cell, plan.cell);
  EXPECT_NEAR((again.origin - plan.origin).norm(), 0.0, 1e-6);
  EXPECT_TRUE(std::equal(plan.cells.data(), plan.cells.data() + plan.cells.elements(), again.cells.data()));
}

TEST(OccupancyGrid, ReadsPlansOfOthers) {
  const TemporaryDirectory folder;
  ByteImage drawn(3, 1);
  drawn.at(0, 0) = 0;
  drawn.at(1, 0) = 128;
  drawn.at(2, 0) = 255;
  nn::write_image(folder / "map.png", drawn);
  const auto read = [&](const std::string& text) {
    nn::write_file(folder / "map.yaml", text);
    return read_occupancy(folder / "map.yaml");
  };
  const std::string lines =
      "# saved by hand\nimage: \"map.png\"\nresolution: 0.050000 # metres\norigin: [-1.5, 2, 0.000]\n"
      "occupied_thresh: 0.65\nfree_thresh: 0.25\n";
  const OccupancyGrid plan = read(lines + "negate: 0\n");
  EXPECT_EQ(plan.cell, 0.05);
  EXPECT_EQ(plan.origin, Eigen::Vector2d(-1.5, 2.0));
  EXPECT_EQ(plan.cells.at(0, 0), OccupancyGrid::kBlocked);
  EXPECT_EQ(plan.cells.at(1, 0), OccupancyGrid::kUnknown);
  EXPECT_EQ(plan.cells.at(2, 0), OccupancyGrid::kFree);
  EXPECT_EQ(read(lines + "negate: 1\n").cells.at(0, 0), OccupancyGrid::kFree);
  expect_error<InputError>([&] { read(lines); }, {"map.yaml", "negate"});
  expect_error<InputError>([&] { read("image: map.png\nresolution: 0\n"); }, {"a resolution above 0"});
  expect_error<InputError>([&] { read("image: map.png\nresolution: wide\n"); }, {"1 number", "wide"});
  expect_error<InputError>([&] { read("resolution: 1\norigin: [0, 0, 1.5]\n"); }, {"not turned", "1.5 rad"});
  const auto refuses = [&](const std::string& text, std::initializer_list<std::string> parts) {
    expect_error<InputError>([&] { read(text); }, parts);
  };
  refuses("\nresolution: 0.05abc\n", {"map.yaml:2", "1 number", "0.05abc"});
  refuses("resolution: 0.05 1\n", {"map.yaml:1", "1 number", "0.05 1"});
  refuses("resolution: [0.05]\n", {"map.yaml:1", "1 number", "[0.05]"});
  refuses("resolution: 1e-9\n", {"map.yaml:1", "0.001 to 100", "1e-09"});
  refuses("resolution: 101\n", {"0.001 to 100", "101"});
  refuses("resolution: 1\norigin: [0, 0, 0, 9]\n", {"map.yaml:2", "3 numbers", "[0, 0, 0, 9]"});
  refuses("resolution: 1\norigin: [0, 0\n", {"map.yaml:2", "3 numbers"});
  refuses("resolution: 1\norigin: [0, -2e6, 0]\n", {"map.yaml:2", "1000000 metres", "-2000000"});
  refuses("image:\n" + lines.substr(lines.find("resolution")) + "negate: 0\n", {"map.yaml:1", "image"});
}

TEST(OccupancyGrid, OfNothingIsUnknown) {
  const OccupancyGrid plan = occupancy_of(VoxelGrid(0.01), {}, {}, {});
  EXPECT_EQ(plan.cells.elements(), 1U);
  EXPECT_EQ(plan.count(OccupancyGrid::kUnknown), 1);
}

TEST(CloudFiles, AreReadAsTheyWereWritten) {
  VoxelGrid grid(0.1);
  for (int i = 0; i < 50; ++i) {
    grid.add({.place = {0.3F * float(i), -1.0F, 2.0F},
              .weight = 1.0F,
              .colour = {float(i), 100.0F, 200.0F},
              .class_id = std::uint16_t(i % 3)},
             1);
  }
  const TemporaryDirectory folder;
  write_dense_ply(folder / "dense.ply", grid, {"", "potted plant", "tv"});
  const DenseCloud cloud = read_dense_ply(folder / "dense.ply");
  EXPECT_EQ(cloud.classes, (std::vector<std::string>{"", "potted plant", "tv"}));
  ASSERT_EQ(cloud.places.size(), 50U);
  EXPECT_EQ(cloud.places[7][0], 0.3F * 7.0F);
  EXPECT_EQ(cloud.colours[7], (std::array<std::uint8_t, 3>{200, 100, 7}));
  EXPECT_EQ(cloud.labels[7], 1);
  const std::string whole = read_file(folder / "dense.ply");
  for (const std::size_t length : {std::size_t{0}, std::size_t{30}, whole.size() / 4, whole.size() - 1}) {
    write_file(folder / "torn.ply", whole.substr(0, length));
    EXPECT_THROW(read_dense_ply(folder / "torn.ply"), InputError) << length;
  }
  write_pcd(folder / "dense.pcd", grid);
  const std::string pcd = read_file(folder / "dense.pcd");
  EXPECT_EQ(pcd.size() - pcd.find("DATA binary\n") - 12, 50U * 20U);
  EXPECT_NE(pcd.find("FIELDS x y z rgb label\nSIZE 4 4 4 4 4\nTYPE F F F F U\n"), std::string::npos);
}

}  // namespace
}  // namespace penumbra::slam
