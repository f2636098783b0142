#include "slam/geometry/pose_columns.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "tests/support/expect_error.h"

namespace penumbra::slam {
namespace {

using test::expect_error;

std::optional<PoseColumns> find(const std::string& header) {
  return find_pose_columns(column_names(header), header.front() == '#', "poses.csv:1");
}

void expect_columns(const std::string& header, std::size_t time, std::array<std::size_t, 3> position,
                    std::array<std::size_t, 4> quaternion) {
  const std::optional<PoseColumns> columns = find(header);
  ASSERT_TRUE(columns) << header;
  EXPECT_EQ(columns->time, time) << header;
  EXPECT_EQ(columns->position, position) << header;
  EXPECT_EQ(columns->quaternion, quaternion) << header;
}

TEST(PoseColumns, AreFoundByTheNamesThatDataSetsAndToolsUse) {
  expect_columns("# timestamp tx ty tz qx qy qz qw", 0, {1, 2, 3}, {4, 5, 6, 7});
  expect_columns("# Format: t, x, y, z, w, i_x, qx, qy, qz", 0, {1, 2, 3}, {6, 7, 8, 4});
  expect_columns(
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []", 0,
      {1, 2, 3}, {5, 6, 7, 4});
  expect_columns("timestamp,qx,qy,qz,qw,tx,ty,tz", 0, {5, 6, 7}, {1, 2, 3, 4});
  expect_columns("\"Time\";\"rx\";\"ry\";\"rz\";\"rw\";\"px\";\"py\";\"pz\"", 0, {5, 6, 7}, {1, 2, 3, 4});
  expect_columns(
      "idx,stamp,positionX,positionY,positionZ,orientationX,orientationY,orientationZ,orientationW", 1,
      {2, 3, 4}, {5, 6, 7, 8});
  expect_columns(
      "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.pose.pose.position.x,"
      "field.pose.pose.position.y,field.pose.pose.position.z,field.pose.pose.orientation.x,"
      "field.pose.pose.orientation.y,field.pose.pose.orientation.z,field.pose.pose.orientation.w,"
      "field.twist.twist.linear.x,field.twist.twist.linear.y,field.twist.twist.linear.z",
      2, {4, 5, 6}, {7, 8, 9, 10});
  expect_columns(
      "__time,/odom/pose/position/x,/odom/pose/position/y,/odom/pose/position/z,/odom/pose/orientation/x,"
      "/odom/pose/orientation/y,/odom/pose/orientation/z,/odom/pose/orientation/w",
      0, {1, 2, 3}, {4, 5, 6, 7});
  expect_columns("t,x_m,y_m,z_m,w_x,w_y,w_z,q_w,q_x,q_y,q_z", 0, {1, 2, 3}, {8, 9, 10, 7});
  expect_columns("t,vx,vy,vz,wx,wy,wz,gt_x,gt_y,gt_z,quat_w,quat_x,quat_y,quat_z", 0, {7, 8, 9},
                 {11, 12, 13, 10});
}

TEST(PoseColumns, TimesHaveUnitsAndTwoParts) {
  const std::string pose = ",x,y,z,qx,qy,qz,qw";
  EXPECT_EQ(find("#timestamp [ns]" + pose)->unit, TimeUnit::nanoseconds);
  EXPECT_EQ(find("time_us" + pose)->unit, TimeUnit::microseconds);
  EXPECT_EQ(find("timestamp(s)" + pose)->unit, TimeUnit::seconds);
  EXPECT_EQ(find("t" + pose)->unit, std::nullopt);
  for (const std::string names :
       {"sec,nsec", "stamp_secs,stamp_nsecs", "header.stamp.sec,header.stamp.nanosec"}) {
    EXPECT_EQ(find(names + pose)->time, 0U) << names;
    EXPECT_EQ(find(names + pose)->nanoseconds, 1U) << names;
  }
  EXPECT_EQ(find("nanosec,sec" + pose)->time, 1U);
  EXPECT_TRUE(find("frame" + pose)->time_is_index);
  EXPECT_FALSE(find("x,y,z,qx,qy,qz,qw")->time);
}

TEST(PoseColumns, WhatDoesNotFitIsRefusedByName) {
  expect_error<InputError>([] { find("t,x,y,z,roll,pitch,yaw"); }, {"poses.csv:1", "roll, pitch, yaw"});
  expect_error<InputError>([] { find("t,x,y,z,rx,ry,rz"); }, {"angles (rx, ry, rz)"});
  expect_error<InputError>([] { find("# t x y z qx qy qz"); }, {"no qw among t, x, y, z, qx"});
  expect_error<InputError>([] { find("t,x,y,qx,qy,qz,qw"); }, {"no z among"});
  expect_error<InputError>([] { find("t,x,y,z"); }, {"no qx among"});
  expect_error<InputError>([] { find("t,tx,ty,tz,qx,qy,qz,qw,px,py,pz"); }, {"two of x: 'tx' and 'px'"});
}

TEST(PoseColumns, ProseNamesNoColumns) {
  EXPECT_FALSE(find("# ground truth trajectory"));
  EXPECT_FALSE(find("# file: 'rgbd_dataset_freiburg1_xyz.bag'"));
  EXPECT_FALSE(find("# time in s and x y z in metres"));
  EXPECT_FALSE(find("poses"));
  EXPECT_EQ(is_w_first(column_names("# order of the quaternion: qw qx qy qz")), true);
}

TEST(PoseColumns, WhatIsLeftOutHasNames) {
  EXPECT_EQ(find(",t,x,y,z,qx,qy,qz,qw,status")->left_out(),
            (std::vector<std::string>{"one without name", "status"}));
  EXPECT_TRUE(find("t,x,y,z,qx,qy,qz,qw,v_RS_R_x [m s^-1],b_w_RS_S_x [rad s^-1]")->left_out().empty());
}

}  // namespace
}  // namespace penumbra::slam
