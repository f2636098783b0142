#include "penumbra/slam.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <stdexcept>
#include <thread>

#include "tests/library/round_room.h"
#include "tests/library/walls.h"

namespace penumbra {
namespace {

using test::RoundRoom;
using test::Walls;

TrackResult show(Slam& slam, const Walls& walls, int frame) {
  const std::vector<std::uint8_t> left = walls.left(frame), right = walls.right(frame);
  return slam.track({.timestamp = 0.1 * frame, .left = Walls::grey(left), .right = Walls::grey(right)});
}

std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

std::string scratch(const std::string& name) {
  return (std::filesystem::temp_directory_path() / ("penumbra_library_" + name)).string();
}

TEST(LibrarySlam, FollowsAStereoCamera) {
  const Walls walls;
  Slam slam(Walls::stereo());
  for (int frame = 0; frame < 20; ++frame) {
    const TrackResult found = show(slam, walls, frame);
    EXPECT_EQ(found.frame, frame);
    ASSERT_EQ(found.state, State::tracking) << found.why_lost;
    EXPECT_TRUE(found.why_lost.empty());
    EXPECT_NEAR(found.T_world_camera.translation[0], Walls::way(frame), 0.02);
    EXPECT_NEAR(found.T_world_camera.translation[2], 0.0, 0.05);
    if (frame == 0) continue;
    ASSERT_TRUE(found.covariance);
    const double sigma_x = std::sqrt((*found.covariance)[0]), sigma_z = std::sqrt((*found.covariance)[14]);
    EXPECT_GT(sigma_x, 1e-5);
    EXPECT_LT(sigma_x, 0.02);
    EXPECT_GT(sigma_z, sigma_x) << "how far ahead is told less well than how far aside";
    EXPECT_DOUBLE_EQ((*found.covariance)[1], (*found.covariance)[6]);
  }
  slam.finish();
  EXPECT_EQ(slam.trajectory().size(), 20U);
  const MapSnapshot map = slam.snapshot();
  EXPECT_GE(map.keyframes.size(), 1U);
  ASSERT_GT(map.points.size(), 100U);
  for (const MapPoint& point : map.points) {
    const bool on_near = std::abs(point.position[2] - 500.0 * 0.5 / 30) < 1.0;
    const bool on_far = std::abs(point.position[2] - 500.0 * 0.5 / 10) < 4.0;
    EXPECT_TRUE(on_near || on_far) << point.position[2];
  }
}

TEST(LibrarySlam, FollowsACameraWithDepthInUnitsOrMetres) {
  const Walls walls;
  const std::vector<std::uint16_t> units = Walls::millimetres();
  std::vector<float> metres;
  for (const std::uint16_t unit : units) metres.push_back(0.001F * unit);
  metres[0] = std::nanf("");  // unknown
  const ImageRef depths[] = {{units.data(), Walls::kWidth, Walls::kHeight, PixelFormat::depth16},
                             {metres.data(), Walls::kWidth, Walls::kHeight, PixelFormat::depth32_metres}};
  for (const ImageRef& depth : depths) {
    Slam slam(Rig::rgbd(Walls::camera()), {.deterministic = true});
    TrackResult found;
    for (int frame = 0; frame < 8; ++frame) {
      const std::vector<std::uint8_t> left = walls.left(frame);
      found = slam.track({.timestamp = 0.1 * frame, .left = Walls::grey(left), .depth = depth});
    }
    EXPECT_EQ(found.state, State::tracking) << found.why_lost;
    EXPECT_NEAR(found.T_world_camera.translation[0], Walls::way(7), 0.03);
  }
}

// Colour in either order and rows with a gap show the same as grey rows side by side.
TEST(LibrarySlam, TakesPixelsAsTheyLie) {
  const Walls walls;
  Slam grey(Walls::stereo(), {.deterministic = true}), rgb(Walls::stereo(), {.deterministic = true});
  constexpr int kGap = 7;
  for (int frame = 0; frame < 4; ++frame) {
    const std::vector<std::uint8_t> left = walls.left(frame), right = walls.right(frame);
    std::vector<std::uint8_t> colour;
    for (const std::uint8_t value : left) colour.insert(colour.end(), 3, value);
    std::vector<std::uint8_t> padded;
    for (int y = 0; y < Walls::kHeight; ++y) {
      const auto row = right.begin() + std::ptrdiff_t{y} * Walls::kWidth;
      padded.insert(padded.end(), row, row + Walls::kWidth);
      padded.insert(padded.end(), kGap, 200);
    }
    const Pose a =
        grey.track({.timestamp = 0.1 * frame, .left = Walls::grey(left), .right = Walls::grey(right)})
            .T_world_camera;
    const Pose b = rgb.track({.timestamp = 0.1 * frame,
                              .left = {colour.data(), Walls::kWidth, Walls::kHeight, PixelFormat::rgb8},
                              .right = {padded.data(), Walls::kWidth, Walls::kHeight, PixelFormat::grey8,
                                        Walls::kWidth + kGap}})
                       .T_world_camera;
    EXPECT_EQ(a.translation, b.translation);
    EXPECT_EQ(a.rotation, b.rotation);
  }
}

TEST(LibrarySlam, SaysWhatIsWrongAndGoesOn) {
  const Walls walls;
  Slam slam(Walls::stereo());
  show(slam, walls, 0);
  const std::vector<std::uint8_t> left = walls.left(1), right = walls.right(1);
  Frame good{.timestamp = 0.1, .left = Walls::grey(left), .right = Walls::grey(right)};
  const auto with = [&](auto change) {
    Frame frame = good;
    change(frame);
    return error_of([&] { slam.track(frame); });
  };
  EXPECT_NE(with([](Frame& f) { f.right = {}; }).find("right image: expected an image"), std::string::npos);
  EXPECT_NE(with([](Frame& f) { f.left.width = 320; }).find("expected 640 x 240 pixels"), std::string::npos);
  EXPECT_NE(with([](Frame& f) { f.left.row_bytes = 100; }).find("640 bytes a row"), std::string::npos);
  EXPECT_NE(with([](Frame& f) { f.left.format = PixelFormat::depth16; }).find("grey or colour"),
            std::string::npos);
  EXPECT_NE(with([](Frame& f) { f.timestamp = 0.0; }).find("a time after 0.000000 s"), std::string::npos);
  EXPECT_NE(with([](Frame& f) { f.timestamp = std::nan(""); }).find("a time after"), std::string::npos);
  EXPECT_NE(with([](Frame& f) {
              f.motion = Pose{{2, 0, 0, 0, 1, 0, 0, 0, 1}, {}};
            }).find("expected a rotation"),
            std::string::npos);
  EXPECT_EQ(slam.track(good).state, State::tracking) << "as if nothing had been";

  EXPECT_NE(error_of([] { Slam(Rig::stereo({}, 0.5)); }).find("focal lengths"), std::string::npos);
  EXPECT_NE(error_of([] { Rig::rgbd(Walls::camera(), 0.0); }).find("above zero"), std::string::npos);
  EXPECT_NE(error_of([] { Rig::read("/nowhere/calibration.yaml"); }).find("/nowhere"), std::string::npos);
  EXPECT_NE(error_of([] { Slam(Walls::stereo(), {.map = "/nowhere/a.map"}); }).find("/nowhere"),
            std::string::npos);
  EXPECT_NE(error_of([] { Slam(Walls::stereo(), {.weights = "/nowhere/w"}); }).find("/nowhere"),
            std::string::npos);
  for (const char* dynamics : {"depth-clusters", "sometimes"}) {
    EXPECT_NE(error_of([&] {
                Slam(Walls::stereo(), {.weights = "/nowhere/w", .dynamics = dynamics});
              }).find(dynamics),
              std::string::npos);
  }
}

TEST(LibrarySlam, SaysWhyAFrameIsLost) {
  const Walls walls;
  Slam slam(Walls::stereo());
  for (int frame = 0; frame < 5; ++frame) show(slam, walls, frame);
  const std::vector<std::uint8_t> black(std::size_t{Walls::kWidth} * Walls::kHeight, 0);
  const TrackResult lost =
      slam.track({.timestamp = 0.5, .left = Walls::grey(black), .right = Walls::grey(black)});
  EXPECT_EQ(lost.state, State::lost);
  EXPECT_FALSE(lost.covariance);
  EXPECT_NE(lost.why_lost.find("black"), std::string::npos) << lost.why_lost;
  const TrackResult found = show(slam, walls, 6);
  EXPECT_EQ(found.state, State::tracking);
  EXPECT_TRUE(found.recovered);
}

TEST(LibrarySlam, AMapIsSavedAndFoundAgain) {
  const Walls walls;
  const std::string file = scratch("walls.map");
  {
    Slam slam(Walls::stereo());
    for (int frame = 0; frame < 20; ++frame) show(slam, walls, frame);
    slam.save_map(file);
    EXPECT_EQ(show(slam, walls, 20).state, State::tracking) << "saving does not end it";
  }
  Slam slam(Walls::stereo(), {.map = file, .localise = true});
  TrackResult found;
  for (int frame = 10; frame < 16; ++frame) found = show(slam, walls, frame);
  EXPECT_EQ(found.state, State::tracking) << found.why_lost;
  EXPECT_NEAR(found.T_world_camera.translation[0], Walls::way(15), 0.05) << "in the world of the map";
  std::filesystem::remove(file);
}

// With a focal length that is 2 % too short, once round seems more than once round, until the camera sees
// again where it began: the loop is closed, and what was placed near the camera has to move along.
TEST(LibrarySlam, TellsHowAClosedLoopMovedTheMap) {
  constexpr double kStep = 4.0 * std::numbers::pi / 180;
  constexpr int kRound = 90;
  const auto yaw_of = [](const Pose& T_world_camera) {
    return std::atan2(T_world_camera.rotation[2], T_world_camera.rotation[8]);
  };
  const RoundRoom room;
  Slam slam(RoundRoom::rig(0.98), {.deterministic = true});
  std::vector<Pose> told;
  slam.on_map_changed([&](const Pose& T_new_old) { told.push_back(T_new_old); });
  Pose before;
  double largest = 0.0;
  for (int frame = 0; frame < kRound + 20; ++frame) {
    const double yaw = frame * kStep;
    const std::vector<std::uint8_t> left = room.view(yaw, 0), right = room.view(yaw, 1);
    const std::size_t earlier = told.size();
    const TrackResult found = slam.track(
        {.timestamp = 0.1 * frame, .left = RoundRoom::grey(left), .right = RoundRoom::grey(right)});
    ASSERT_EQ(found.state, State::tracking) << frame << ": " << found.why_lost;
    Pose moved = before;  // where the frame before is in the map as it is now
    for (std::size_t i = earlier; i < told.size(); ++i) moved = told[i] * moved;
    const Pose step = moved.inverse() * found.T_world_camera;
    const double bent = told.size() > earlier ? 0.15 : 0.05;  // metres, a closed loop between the two frames
    EXPECT_NEAR(yaw_of(step), frame == 0 ? 0.0 : kStep / 0.98, bent / 5) << frame;
    for (const double metres : step.translation) EXPECT_NEAR(metres, 0.0, bent) << frame;
    for (std::size_t i = earlier; i < told.size(); ++i)
      largest = std::max(largest, std::abs(yaw_of(told[i])));
    before = found.T_world_camera;
  }
  slam.finish();
  EXPECT_GE(slam.snapshot().loops, 1);
  EXPECT_GT(largest, 0.05) << "2 % of a turn is 0.126 radians";
}

TEST(LibrarySlam, AfterAResetAllIsAsAtTheBeginning) {
  const Walls walls;
  Slam slam(Walls::stereo(), {.deterministic = true});
  const auto drive = [&] {
    Pose last;
    for (int frame = 0; frame < 6; ++frame) last = show(slam, walls, frame).T_world_camera;
    return last.translation;
  };
  const std::array<double, 3> first = drive();
  slam.reset();
  EXPECT_TRUE(slam.trajectory().empty());
  EXPECT_TRUE(slam.snapshot().keyframes.empty());
  EXPECT_EQ(drive(), first);
}

TEST(LibrarySlam, AnotherThreadMayLookAtTheMap) {
  const Walls walls;
  Slam slam(Walls::stereo());
  std::atomic<bool> ended = false;
  std::size_t most = 0;
  std::thread looker([&] {
    while (!ended) most = std::max(most, slam.snapshot().points.size());
  });
  for (int frame = 0; frame < 15; ++frame) show(slam, walls, frame);
  slam.finish();
  most = std::max(most, std::size_t{0});
  slam.reset();  // while it may be looking
  show(slam, walls, 0);
  ended = true;
  looker.join();
  EXPECT_GT(most, 0U);
}

// Half of the wall's pattern further in one step: images alone find it by descriptors, wheels say where to
// look.
TEST(LibrarySlam, WheelsTellWhereToLook) {
  const Walls walls;
  Slam slam(Walls::stereo(), {.deterministic = true});
  for (int frame = 0; frame < 5; ++frame) show(slam, walls, frame);
  constexpr int kJump = 20;
  Pose step;  // T_now_before: what was ahead of the camera is now to its left
  step.translation[0] = -(Walls::way(kJump) - Walls::way(4));
  const std::vector<std::uint8_t> left = walls.left(kJump), right = walls.right(kJump);
  const TrackResult found =
      slam.track({.timestamp = 0.5, .left = Walls::grey(left), .right = Walls::grey(right), .motion = step});
  EXPECT_EQ(found.state, State::tracking) << found.why_lost;
  EXPECT_NEAR(found.T_world_camera.translation[0], Walls::way(kJump), 0.05);
}

TEST(LibraryPose, ComposesInvertsAndMakesQuaternions) {
  const Pose turn{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {1, 2, 3}};  // a quarter about z
  EXPECT_EQ((turn * std::array<double, 3>{1, 0, 0}), (std::array<double, 3>{1, 3, 3}));
  const Pose none = turn * turn.inverse();
  EXPECT_EQ(none.rotation, Pose{}.rotation);
  for (const double value : none.translation) EXPECT_NEAR(value, 0.0, 1e-15);
  const std::array<double, 4> q = turn.quaternion();
  EXPECT_NEAR(q[2], std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(q[3], std::sqrt(0.5), 1e-15);
  EXPECT_EQ(Pose({{1, 0, 0, 0, -1, 0, 0, 0, -1}, {}}).quaternion(), (std::array<double, 4>{1, 0, 0, 0}));
}

}  // namespace
}  // namespace penumbra
