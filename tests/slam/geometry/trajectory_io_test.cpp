#include "slam/geometry/trajectory_io.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"
#include "tests/support/trajectories.h"

namespace penumbra::slam {
namespace {

using test::expect_error;

class TrajectoryIo : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& text) const {
    nn::write_file(folder_ / "poses.txt", text);
    return folder_ / "poses.txt";
  }
  test::TemporaryDirectory folder_;
};

TEST_F(TrajectoryIo, KittiPosesComeBackExactly) {
  const Trajectory trajectory = test::winding_trajectory(50);
  write_kitti_poses(folder_ / "a.txt", trajectory);
  const std::vector<SE3> poses = read_kitti_poses(folder_ / "a.txt");
  ASSERT_EQ(poses.size(), trajectory.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].rotation, trajectory[i].T_wc.rotation);
    EXPECT_EQ(poses[i].translation, trajectory[i].T_wc.translation);
  }
  write_kitti_poses(folder_ / "b.txt", poses);
  EXPECT_EQ(nn::read_file(folder_ / "a.txt", ""), nn::read_file(folder_ / "b.txt", ""));
}

TEST_F(TrajectoryIo, KittiRotationsKeepTheirRounding) {
  const std::vector<SE3> poses = read_kitti_poses(file("0.9999 0 0 1 0 1 0 2 0 0 1 3\n"));
  EXPECT_EQ(poses[0].rotation(0, 0), 0.9999);
  EXPECT_EQ(poses[0].translation, Eigen::Vector3d(1, 2, 3));
}

TEST_F(TrajectoryIo, ZeroHasNoSign) {
  const Trajectory trajectory = {{0.0, SE3{}.inverse()}};
  write_tum_trajectory(folder_ / "a.txt", trajectory);
  write_kitti_poses(folder_ / "b.txt", trajectory);
  EXPECT_EQ(nn::read_file(folder_ / "a.txt", ""),
            "# timestamp tx ty tz qx qy qz qw\n0.000000000 0 0 0 0 0 0 1\n");
  EXPECT_EQ(nn::read_file(folder_ / "b.txt", ""), "1 0 0 0 0 1 0 0 0 0 1 0\n");
}

TEST_F(TrajectoryIo, TumTrajectoryComesBack) {
  Trajectory trajectory = test::winding_trajectory(50);
  for (TimedPose& pose : trajectory) pose.timestamp += 1311868164.363181;
  write_tum_trajectory(folder_ / "a.txt", trajectory);
  const Trajectory read = read_tum_trajectory(folder_ / "a.txt");
  ASSERT_EQ(read.size(), trajectory.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(read[i].timestamp, trajectory[i].timestamp, 1e-9 + 3e-7);
    EXPECT_LT((read[i].T_wc.rotation - trajectory[i].T_wc.rotation).norm(), 1e-12);
    EXPECT_EQ(read[i].T_wc.translation, trajectory[i].T_wc.translation);
  }
}

TEST_F(TrajectoryIo, TumQuaternionsAreScalarLast) {
  const Trajectory read = read_tum_trajectory(file("# comment\n1.5 1 2 3 0 0 0.70710678 0.70710678\n"));
  ASSERT_EQ(read.size(), 1U);
  EXPECT_EQ(read[0].timestamp, 1.5);
  EXPECT_LT((read[0].T_wc * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-12);
}

TEST_F(TrajectoryIo, WrongColumnsAndNanAreRefusedWithTheirLine) {
  expect_error<InputError>([&] { read_kitti_poses(file("1 0 0 0 0 1 0 0 0 0 1\n")); },
                           {"poses.txt:1", "12 numbers", "11 numbers"});
  expect_error<InputError>([&] { read_tum_trajectory(file("# x\n0 0 0 0 0 0 0 1\n1 0 0 0 0 0 1\n")); },
                           {"poses.txt:3", "8 numbers", "7 numbers"});
  expect_error<InputError>([&] { read_kitti_poses(file("1 0 0 nan 0 1 0 0 0 0 1 0\n")); },
                           {"poses.txt:1", "finite", "nan"});
  expect_error<InputError>([&] { read_tum_trajectory(file("nan 0 0 0 0 0 0 1\n")); }, {"poses.txt:1", "nan"});
}

TEST_F(TrajectoryIo, WhatIsNoRotationIsRefusedWithItsLine) {
  const std::string good = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  expect_error<InputError>([&] { read_kitti_poses(file(good + "1.01 0 0 0 0 1 0 0 0 0 1 0\n")); },
                           {"poses.txt:2", "a rotation matrix", "off by 0.0201"});
  expect_error<InputError>([&] { read_kitti_poses(file("0 0 0 0 0 0 0 0 0 0 0 0\n")); }, {"off by 1"});
  expect_error<InputError>([&] { read_kitti_poses(file("1e200 0 0 0 0 1 0 0 0 0 1 0\n")); }, {"off by inf"});
  expect_error<InputError>([&] { read_kitti_poses(file("-1 0 0 0 0 1 0 0 0 0 1 0\n")); }, {"a reflection"});
  expect_error<InputError>([&] { read_tum_trajectory(file("0 0 0 0 0 0 0 0\n")); },
                           {"poses.txt:1", "a quaternion", "length 0"});
}

TEST_F(TrajectoryIo, TimesThatGoBackAreSortedAndSaid) {
  Notes notes;
  const Trajectory read =
      read_tum_trajectory(file("2 2 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n3 3 0 0 0 0 0 1\n"), &notes);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(read[i].T_wc.translation.x(), read[i].timestamp);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("time goes back in 1 line; the poses are sorted"), std::string::npos) << notes[0];
}

TEST_F(TrajectoryIo, QuaternionsOfAnyLengthAreNormalisedAndSaid) {
  Notes notes;
  const Trajectory read = read_tum_trajectory(file("1 0 0 0 0 0 2 2\n2 0 0 0 0 0 0 1.0001\n"), &notes);
  EXPECT_LT((read[0].T_wc.rotation * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("not of length 1: 1 of 2 quaternions"), std::string::npos) << notes[0];
  expect_error<InputError>([&] { read_tum_trajectory(file("1 0 0 0 1e200 1e200 0 0\n")); }, {"length inf"});
}

TEST_F(TrajectoryIo, TumTimesMayBeInAnyUnit) {
  Notes notes;
  const std::string pose = " 0 0 0 0 0 0 1\n";
  const Trajectory read = read_tum_trajectory(
      file("1600000000000000000" + pose + "1600000000100000000" + pose + "1600000000200000000" + pose),
      &notes);
  EXPECT_NEAR(read[1].timestamp, 1600000000.1, 1e-6);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("nanoseconds (not seconds)"), std::string::npos);
}

TEST_F(TrajectoryIo, CsvIsEurocsUnlessTheHeaderSaysOtherwise) {
  Notes notes;
  const std::string numbers =
      "1600000000000000000,1,2,3,0.70710678,0,0,0.70710678,9,9\n1600000000100000000,1,2,3,1,0,0,0,9,9\n";
  const std::string header =
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
      "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1]\n";
  EXPECT_EQ(detect_trajectory_format(file(header + numbers)), TrajectoryFormat::euroc);
  const Trajectory read = read_euroc_trajectory(file(header + numbers), &notes);
  EXPECT_TRUE(notes.empty());
  EXPECT_NEAR(read[1].timestamp - read[0].timestamp, 0.1, 1e-6);
  EXPECT_LT((read[0].T_wc * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-7);
  read_euroc_trajectory(file(numbers), &notes);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("no header"), std::string::npos);
  const Trajectory tum = read_euroc_trajectory(
      file("time,tx,ty,tz,qx,qy,qz,qw\r\n0.0,1,2,3,0,0,0.70710678,0.70710678\r\n0.1,1,2,3,0,0,0,1\r\n"),
      &notes);
  EXPECT_LT((tum[0].T_wc * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-7);
  EXPECT_EQ(tum[1].timestamp, 0.1);
  expect_error<InputError>([&] { read_euroc_trajectory(file("1,2,3\n")); },
                           {"poses.txt:1", "at least 8 numbers"});
}

TEST_F(TrajectoryIo, AHeaderOfUnknownNamesIsRefusedAndATitleIsNot) {
  expect_error<InputError>([&] { read_euroc_trajectory(file("a,b,c,d,e,f,g,h\n0,0,0,0,1,0,0,0\n")); },
                           {"poses.txt:1", "names of columns that are known", "a, b, c"});
  EXPECT_EQ(read_tum_trajectory(file("poses of run 7\n0 0 0 0 0 0 0 1\n")).size(), 1U);
  EXPECT_EQ(read_kitti_poses(file("a b c d e f g h i j k l\n1 0 0 5 0 1 0 6 0 0 1 7\n")).size(), 1U);
}

TEST_F(TrajectoryIo, NamedColumnsMayHoldTextButNoHoles) {
  const std::string header = "stamp_sec,stamp_nanosec,frame,x,y,z,qw,qx,qy,qz\n";
  Notes notes;
  const Trajectory read = read_euroc_trajectory(
      file(header + "1600000000,5,map,1,2,3,1,0,0,0\n1600000000,100000005,map,1,2,3,1,0,0,0\n"), &notes);
  EXPECT_EQ(read[0].T_wc.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(read[1].timestamp - read[0].timestamp, 0.1, 1e-6);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("left out: frame"), std::string::npos) << notes[0];
  expect_error<InputError>([&] { read_euroc_trajectory(file(header + "1600000000,5,map,1,,3,1,0,0,0\n")); },
                           {"poses.txt:2", "an empty field"});
  expect_error<InputError>([&] { read_euroc_trajectory(file(header + "1600000000,5,map,1,3,1,0,0,0\n")); },
                           {"poses.txt:2", "10 fields", "9"});
  expect_error<InputError>([&] { read_euroc_trajectory(file(header + "1600000000,2e9,a,1,2,3,1,0,0,0\n")); },
                           {"0 to 999999999 nanoseconds"});
}

TEST_F(TrajectoryIo, KittiLinesMayHoldTheLastRowAndTheFrame) {
  const std::string pose = "1 0 0 5 0 1 0 6 0 0 1 7", last = " 0 0 0 1";
  for (const std::string& text : {pose + last + "\n", "3 " + pose + "\n", "3 " + pose + last + "\n"}) {
    EXPECT_EQ(detect_trajectory_format(file(text)), TrajectoryFormat::kitti);
    EXPECT_EQ(read_kitti_poses(file(text)).at(0).translation, Eigen::Vector3d(5, 6, 7));
  }
  EXPECT_EQ(read_kitti_trajectory(file("3 " + pose + "\n5 " + pose + "\n"))[1].timestamp, 5.0);
  expect_error<InputError>([&] { read_kitti_poses(file("5 " + pose + "\n5 " + pose + "\n")); },
                           {"poses.txt:2", "the frame's number"});
  expect_error<InputError>([&] { read_kitti_poses(file(pose + " 0 0 1 0\n")); }, {"poses.txt:1", "0 0 0 1"});
  expect_error<InputError>([&] { read_kitti_poses(file(pose + "\n" + pose + last + "\n")); },
                           {"poses.txt:2", "12 numbers", "16 numbers"});
}

TEST_F(TrajectoryIo, TartanAirHasNoTimes) {
  Notes notes;
  const std::string text = "1 2 3 0 0 0.70710678 0.70710678\n1 2 3 0 0 0 1\n";
  EXPECT_EQ(detect_trajectory_format(file(text)), TrajectoryFormat::tartanair);
  const Trajectory read = read_trajectory(file(text), TrajectoryFormat::tartanair, &notes);
  EXPECT_EQ(read[1].timestamp, 1.0);
  EXPECT_LT((read[0].T_wc * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 3)).norm(), 1e-7);
  ASSERT_EQ(notes.size(), 1U);
}

TEST_F(TrajectoryIo, MissingAndEmptyFilesAreRefused) {
  expect_error<InputError>([&] { read_kitti_poses(folder_ / "no.txt"); }, {"no.txt", "no such file"});
  expect_error<InputError>([&] { read_tum_trajectory(folder_.path()); }, {"a folder"});
  expect_error<InputError>([&] { read_kitti_poses(file("")); }, {"at least one pose", "none"});
  expect_error<InputError>([&] { read_tum_trajectory(file("# only a comment\n")); }, {"at least one pose"});
}

TEST_F(TrajectoryIo, FormatIsToldByTheColumns) {
  EXPECT_EQ(detect_trajectory_format(file("1 0 0 0 0 1 0 0 0 0 1 0\n")), TrajectoryFormat::kitti);
  EXPECT_EQ(detect_trajectory_format(file("# t\n\n0 0 0 0 0 0 0 1\n")), TrajectoryFormat::tum);
  expect_error<InputError>([&] { detect_trajectory_format(file("# a\n1 2 3\n")); },
                           {"poses.txt:2", "12 numbers (KITTI", "3 numbers"});
  expect_error<InputError>([&] { detect_trajectory_format(file("\n")); }, {"at least one pose"});
}

TEST_F(TrajectoryIo, AFolderThatIsNotThereIsAnError) {
  const Trajectory trajectory = test::winding_trajectory(2);
  expect_error<Error>([&] { write_kitti_poses(folder_ / "no/a.txt", trajectory); }, {"no/a.txt"});
  expect_error<Error>([&] { write_tum_trajectory(folder_ / "no/a.txt", trajectory); }, {"no/a.txt"});
}

}  // namespace
}  // namespace penumbra::slam
