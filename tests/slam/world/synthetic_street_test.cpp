// The synthetic street as a whole: repeatable, clear of the drive, rich enough for features, safe on bad
// input.
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <opencv2/features2d.hpp>

#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "slam/world/noise.h"
#include "tests/slam/world/synthetic_support.h"
#include "tests/support/cv_images.h"
#include "tests/support/test_data.h"

namespace penumbra::slam::synthetic {
namespace {

using test::TemporaryDirectory;

std::uint64_t hash_of_frames(std::uint32_t seed, int threads) {
  const int before = thread_count();
  set_thread_count(threads);
  StreetSequence street({.size = {310, 94}, .seed = seed, .colour = true});
  SequenceFrame frame;
  std::uint64_t hash = 1;
  for (const int i : {0, 17, 42}) {
    street.render(i, frame);
    for (const ByteImage& image : {frame.left_grey, frame.right_grey, frame.left_bgr}) {
      hash = hash_image(image, hash);
    }
    hash = hash_image(frame.left.instance, hash_image(frame.left.depth, hash));
  }
  set_thread_count(before);
  return hash;
}

TEST(SyntheticStreet, TheSameSeedGivesTheSameBytesForAnyNumberOfThreads) {
  const std::uint64_t one = hash_of_frames(3, 1);
  EXPECT_EQ(one, hash_of_frames(3, 2));
  EXPECT_EQ(one, hash_of_frames(3, 5));
  EXPECT_NE(one, hash_of_frames(4, 2));
}

TEST(SyntheticStreet, FramesDoNotDependOnTheOrderInWhichTheyAreRendered) {
  StreetSequence street({.size = {310, 94}});
  SequenceFrame forth, back;
  street.render(1, forth);
  street.render(30, back);
  street.render(1, back);
  EXPECT_EQ(hash_image(forth.left_grey), hash_image(back.left_grey));
}

TEST(SyntheticStreet, CornersAreManyAndSpreadOverTheImage) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    StreetSequence street({.seed = seed});
    SequenceFrame frame;
    for (const int i : {0, 25, 50}) {
      street.render(i, frame);
      std::vector<cv::KeyPoint> corners;
      cv::FastFeatureDetector::create(20)->detect(test::to_mat(frame.left_grey), corners);
      EXPECT_GT(corners.size(), 1000U) << "seed " << seed << " frame " << i;
      int cells[4][8] = {}, filled = 0;
      for (const cv::KeyPoint& corner : corners) {
        ++cells[static_cast<int>(corner.pt.y) * 4 / 188][static_cast<int>(corner.pt.x) * 8 / 620];
      }
      for (const auto& row : cells) {
        for (const int count : row) filled += count >= 3 ? 1 : 0;
      }
      EXPECT_GE(filled, 24) << "of 32 cells, seed " << seed << " frame " << i;
    }
  }
}

TEST(SyntheticStreet, ACarPassesAndParkedCarsStandOnBothSides) {
  StreetSequence street({});
  bool moves = false, left = false, right = false;
  for (const Object& object : street.world().objects) {
    if (object.object_class != ObjectClass::car && object.object_class != ObjectClass::truck) continue;
    if (object.motion.moves) {
      moves = moves || object.motion.speed < 0.0;
      continue;
    }
    const RoadPoint at = street.world().road_map.at(static_cast<float>(object.pose.position.x()),
                                                    static_cast<float>(object.pose.position.y()));
    (at.lateral > 0.0F ? right : left) = true;
  }
  EXPECT_TRUE(moves);
  EXPECT_TRUE(left);
  EXPECT_TRUE(right);
}

// Nothing that stands still may come closer than a metre to where the camera drives.
void expect_clear_drive(const Drive& drive, const World& world) {
  for (const Object& object : world.objects) {
    if (object.motion.moves) continue;
    const Eigen::Matrix3d to_local = rotation_of(object.pose.heading).transpose();
    for (const TimedPose& pose : drive.poses) {
      const Eigen::Vector3d offset(pose.T_wc.translation.x() - object.pose.position.x(), 0.0,
                                   pose.T_wc.translation.z() - object.pose.position.y());
      if (offset.norm() > 40.0) continue;
      const Eigen::Vector3d local = to_local * offset;
      const bool tree_or_lamp = object.lower.y() < -4.0F && object.upper.x() - object.lower.x() < 5.0F;
      if (tree_or_lamp) {
        EXPECT_GT(local.norm(), 2.0);
        continue;
      }
      const bool clear = local.x() < object.lower.x() - 1.0 || local.x() > object.upper.x() + 1.0 ||
                         local.z() < object.lower.z() - 1.0 || local.z() > object.upper.z() + 1.0;
      ASSERT_TRUE(clear) << "object at " << object.pose.position.transpose() << " stands in the way at "
                         << pose.T_wc.translation.transpose();
    }
  }
}

std::filesystem::path write_figure_of_eight(const TemporaryDirectory& folder) {
  const std::filesystem::path path = folder / "eight.txt";
  std::ofstream file(path);
  for (int i = 0; i < 600; ++i) {
    const double t = 4.0 * std::numbers::pi * i / 600;  // twice round
    const double x = 40.0 * std::sin(t), z = 25.0 * std::sin(2.0 * t);
    const double heading = std::atan2(40.0 * std::cos(t), 50.0 * std::cos(2.0 * t));
    const double c = std::cos(heading), s = std::sin(heading);
    file << c << " 0 " << s << " " << x << " 0 1 0 0 " << -s << " 0 " << c << " " << z << "\n";
  }
  return path;
}

TEST(SyntheticStreet, HousesAndParkedCarsNeverStandInTheDrivesWay) {
  const TemporaryDirectory folder;
  for (const char* preset : {"street", "crowded"}) {
    const Drive block = make_drive("block", 284);
    expect_clear_drive(block, build_street(block, street_preset(preset), 1));
    const Drive eight = load_drive(write_figure_of_eight(folder), 0);
    expect_clear_drive(eight, build_street(eight, street_preset(preset), 2));
  }
}

// No two cars, nor the camera and a car, come closer than neighbouring lanes are apart.
void expect_no_collision(const Drive& drive, const World& world) {
  const auto place_of = [](const SE3& pose) {
    return Eigen::Vector2d(pose.translation.x(), pose.translation.z());
  };
  std::vector<const Object*> cars;
  for (const Object& object : world.objects) {
    if (object.motion.moves && object.object_class != ObjectClass::person &&
        object.object_class != ObjectClass::cyclist) {
      cars.push_back(&object);
    }
  }
  for (std::size_t frame = 0; frame < drive.poses.size(); frame += 4) {
    const TimedPose& pose = drive.poses[frame];
    std::vector<Eigen::Vector2d> places{place_of(pose.T_wc)};
    for (const Object* car : cars) places.push_back(pose_at(world, *car, pose.timestamp).position);
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) ASSERT_GT((places[i] - places[k]).norm(), 2.3) << "frame " << frame;
    }
  }
}

TEST(SyntheticStreet, NothingRunsIntoAnythingWhereAFigureOfEightCrossesItself) {
  const Drive eight = make_drive("eight", 1150);
  for (const char* preset : {"street", "crowded", "lorry"}) {
    const World world = build_street(eight, street_preset(preset), 3);
    expect_clear_drive(eight, world);
    expect_no_collision(eight, world);
    // Both roads run on through the crossing, which is a junction.
    EXPECT_TRUE(world.road_map.at(0.0F, 40.0F).junction);
    for (const float away : {-30.0F, 30.0F}) {
      EXPECT_FALSE(world.road_map.at(0.0F, 40.0F + away).junction);
      EXPECT_LT(world.road_map.at(away, 40.0F).distance, 4.0F);
      EXPECT_LT(world.road_map.at(0.0F, 40.0F + away).distance, 4.0F);
    }
  }
}

TEST(SyntheticStreet, AFigureOfEightClosesAfterAsManyFramesAsDocumented) {
  const Drive eight = make_drive("eight", 1200);
  const auto place = [&](std::size_t i) { return eight.poses[i].T_wc.translation; };
  EXPECT_LT((place(575) - place(0)).norm(), 0.8);
  EXPECT_LT(std::abs(place(50).x()), 0.01);  // on the crossing for the first time, heading along z
  EXPECT_NEAR(place(50).z(), 40.0, 0.5);
}

TEST(SyntheticStreet, APlaceLooksTheSameAgainExceptForWhatMoves) {
  StreetSequence street({.path = "eight", .frames = 600});
  const SE3 pose = street.poses()[10].T_wc;
  RayCaster caster(street.world());
  RenderedView first, again;
  caster.render(street.camera(), pose, 1.0, first);
  caster.render(street.camera(), pose, 58.5, again);
  std::vector<bool> moves(65536, false);
  for (const Object& object : street.world().objects) moves[object.instance] = object.motion.moves;
  int compared = 0, same = 0;
  for (int v = 0; v < 188; ++v) {
    for (int u = 0; u < 620; ++u) {
      if (moves[first.instance.at(u, v)] || moves[again.instance.at(u, v)]) continue;
      ++compared;
      EXPECT_EQ(first.depth.at(u, v), again.depth.at(u, v));
      same += first.radiance.at(u, v) == again.radiance.at(u, v) ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 620 * 188 / 2);
  EXPECT_GT(same, compared * 97 / 100);  // the rest are silhouettes and shadows of what moved
}

TEST(SyntheticStreet, StreetsAroundKittiDrivesAreClearOfHousesAndCars) {
  PENUMBRA_REAL_DATA(folder, "kitti/poses");
  for (const char* name : {"00", "01", "04", "05", "06", "07", "09", "10"}) {
    SCOPED_TRACE(name);
    const Drive drive = load_drive(folder / (std::string(name) + ".txt"), 0);
    const World world = build_street(drive, street_preset("street"), 1);
    expect_clear_drive(drive, world);
    expect_no_collision(drive, world);
  }
}

TEST(SyntheticStreet, AKittiDriveKeepsItsPositionsAndHeadings) {
  PENUMBRA_REAL_DATA(file, "kitti/poses/07.txt");
  const Drive drive = load_drive(file, 0);
  ASSERT_EQ(drive.poses.size(), 1101U);
  std::ifstream stream(file);
  for (const TimedPose& pose : drive.poses) {
    double values[12];
    for (double& value : values) stream >> value;
    EXPECT_NEAR(pose.T_wc.translation.x(), values[3], 1e-9);
    EXPECT_NEAR(pose.T_wc.translation.z(), values[11], 1e-9);
    const double heading = std::atan2(pose.T_wc.rotation(0, 2), pose.T_wc.rotation(2, 2));
    EXPECT_NEAR(std::remainder(heading - std::atan2(values[2], values[10]), 2.0 * std::numbers::pi), 0.0,
                1e-3);
  }
  const World world = build_street(drive, street_preset("street"), 1);
  expect_clear_drive(drive, world);
  EXPECT_GT(world.objects.size(), 500U);
}

TEST(SyntheticStreet, BadPoseFilesAreInputErrors) {
  const TemporaryDirectory folder;
  const auto load = [&](const std::string& text) {
    std::ofstream(folder / "poses.txt") << text;
    return load_drive(folder / "poses.txt", 0);
  };
  const std::string identity = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  EXPECT_NO_THROW(load(identity));  // one pose makes a drive of one frame
  EXPECT_NO_THROW(load(identity + identity + identity));
  EXPECT_THROW(load_drive(folder / "missing.txt", 0), InputError);
  EXPECT_THROW(load_drive(folder.path(), 0), InputError);
  EXPECT_THROW(load(""), InputError);
  EXPECT_THROW(load("1 0 0 0 0 1 0 0 0 0 1\n"), InputError);
  EXPECT_THROW(load("1 0 0 nan 0 1 0 0 0 0 1 0\n"), InputError);
  EXPECT_THROW(load("1 0 0 x 0 1 0 0 0 0 1 0\n"), InputError);
  EXPECT_THROW(load("2 0 0 0 0 1 0 0 0 0 1 0\n"), InputError);
  EXPECT_THROW(load(identity + "1 0 0 0 0 1 0 0 0 0 1 900\n"), InputError);
  std::ofstream(folder / "poses.txt") << identity;
  EXPECT_THROW(load_drive(folder / "poses.txt", 2), UsageError);
}

TEST(SyntheticStreet, PathsThatNoCarDrivesStillRender) {
  const TemporaryDirectory folder;
  const std::string path = (folder / "poses.txt").string();
  const auto render = [&] {
    StreetSequence street({.path = path, .size = {64, 48}});
    SequenceFrame frame;
    for (int i = 0; i < street.size(); i += 7) street.render(i, frame);
    return street.size();
  };
  std::ofstream backwards(path);  // looks against its motion
  for (int i = 0; i < 50; ++i) backwards << "-1 0 0 0 0 1 0 0 0 0 -1 " << i << "\n";
  backwards.close();
  EXPECT_EQ(render(), 50);
  std::ofstream to_and_fro(path);  // on one spot, looking up, then jumping about
  RandomSequence random(7);
  for (int i = 0; i < 50; ++i) {
    to_and_fro << "1 0 0 " << random.uniform(-5.0F, 5.0F) << " 0 0 -1 0 0 1 0 " << random.uniform(-5.0F, 5.0F)
               << "\n";
  }
  to_and_fro.close();
  EXPECT_EQ(render(), 50);
}

TEST(SyntheticStreet, SettingsThatMakeNoSenseAreUsageErrors) {
  EXPECT_THROW(StreetSequence({.street = street_preset("jungle")}), UsageError);
  EXPECT_THROW(StreetSequence({.path = "spiral"}), UsageError);
  EXPECT_THROW(StreetSequence({.frames = -1}), UsageError);
  EXPECT_THROW(StreetSequence({.size = {0, 188}}), UsageError);
  EXPECT_THROW(StreetSequence({.size = {620, 100000}}), UsageError);
}

TEST(SyntheticStreet, ASmallImageAndOneFrameWork) {
  StreetSequence street({.path = "straight", .frames = 1, .size = {33, 37}});
  SequenceFrame frame;
  street.render(0, frame);
  EXPECT_EQ(frame.left_grey.size(), (Size{33, 37}));
}

}  // namespace
}  // namespace penumbra::slam::synthetic
