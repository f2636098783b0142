#include "apps/slam/run_messages.h"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <utility>

#include "slam/sources/bag/message_writer.h"

namespace penumbra::apps {

namespace {

using slam::MessageWriter;

// What definitions are made of, as ROS 2 prints them: a type, then those that it uses.
std::string definition(std::string_view fields,
                       std::initializer_list<std::pair<const char*, const char*>> used) {
  std::string text(fields);
  const auto add = [&](std::string_view name, std::string_view of) {
    text += fmt::format("{}\nMSG: {}\n{}", std::string(80, '='), name, of);
  };
  for (const auto& [name, of] : used) add(name, of);
  add("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n");
  add("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
  return text;
}

constexpr std::pair kPose = {"geometry_msgs/Pose", "Point position\nQuaternion orientation\n"};
constexpr std::pair kPoint = {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"};
constexpr std::pair kVector = {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"};
constexpr std::pair kQuaternion = {"geometry_msgs/Quaternion",
                                   "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"};

void put_rotation(MessageWriter& message, const Eigen::Matrix3d& rotation) {
  const Eigen::Quaterniond q(rotation);
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) message.number(value);
}

// A Pose, or a Transform, which has the same numbers.
void put_pose(MessageWriter& message, const slam::SE3& T) {
  for (int i = 0; i < 3; ++i) message.number(T.translation[i]);
  put_rotation(message, T.rotation);
}

}  // namespace

const MessageType kPoseStamped = {
    "geometry_msgs/msg/PoseStamped",
    definition("std_msgs/Header header\nPose pose\n", {kPose, kPoint, kQuaternion})};
const MessageType kPath = {
    "nav_msgs/msg/Path",
    definition(
        "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
        {{"geometry_msgs/PoseStamped", "std_msgs/Header header\nPose pose\n"}, kPose, kPoint, kQuaternion})};
const MessageType kPointCloud2 = {
    "sensor_msgs/msg/PointCloud2",
    definition("std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\nbool is_bigendian\n"
               "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
               {{"sensor_msgs/PointField", "string name\nuint32 offset\nuint8 datatype\nuint32 count\n"}})};
const MessageType kTransforms = {
    "tf2_msgs/msg/TFMessage",
    definition("geometry_msgs/TransformStamped[] transforms\n",
               {{"geometry_msgs/TransformStamped",
                 "std_msgs/Header header\nstring child_frame_id\nTransform transform\n"},
                {"geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation\n"},
                kVector,
                kQuaternion})};

const MessageType kCompressedImage = {
    "sensor_msgs/msg/CompressedImage",
    definition("std_msgs/Header header\nstring format\nuint8[] data\n", {})};
const MessageType kOccupancyGrid = {
    "nav_msgs/msg/OccupancyGrid",
    definition("std_msgs/Header header\nMapMetaData info\nint8[] data\n",
               {{"nav_msgs/MapMetaData",
                 "builtin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\nuint32 height\n"
                 "geometry_msgs/Pose origin\n"},
                kPose,
                kPoint,
                kQuaternion})};

std::string pose_message(std::int64_t time, std::string_view frame, const slam::SE3& pose) {
  MessageWriter message;
  message.header(time, frame);
  put_pose(message, pose);
  return message.bytes();
}

std::string path_message(std::int64_t time, std::string_view frame, const slam::Trajectory& poses) {
  MessageWriter message;
  message.header(time, frame);
  message.number(static_cast<std::uint32_t>(poses.size()));
  for (const slam::TimedPose& pose : poses) {
    message.header(nanoseconds_of(pose.timestamp), frame);
    put_pose(message, pose.T_wc);
  }
  return message.bytes();
}

std::string cloud_message(std::int64_t time, const std::vector<slam::PlyVertex>& points) {
  constexpr std::uint32_t kPointBytes = 16;
  constexpr std::uint8_t kFloat = 7, kUnsigned = 6;
  MessageWriter message;
  message.header(time, "map");
  message.number(std::uint32_t{1});
  message.number(static_cast<std::uint32_t>(points.size()));
  message.number(std::uint32_t{4});
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z", "rgb"}) {
    message.text(name);
    message.number(offset);
    message.number(offset == 12 ? kUnsigned : kFloat);
    message.number(std::uint32_t{1});
    offset += 4;
  }
  message.number(std::uint8_t{0});
  message.number(kPointBytes);
  message.number(static_cast<std::uint32_t>(kPointBytes * points.size()));
  ByteWriter data;
  for (const slam::PlyVertex& point : points) {
    data.put(point.position);
    data.put(static_cast<std::uint32_t>(point.colour[0] << 16 | point.colour[1] << 8 | point.colour[2]));
  }
  message.byte_list(data.bytes());
  message.number(std::uint8_t{1});
  return message.bytes();
}

std::string transforms_message(std::int64_t time, const std::vector<Transform>& transforms) {
  MessageWriter message;
  message.number(static_cast<std::uint32_t>(transforms.size()));
  for (const Transform& transform : transforms) {
    message.header(time, transform.parent);
    message.text(transform.child);
    put_pose(message, transform.T_parent_child);
  }
  return message.bytes();
}

slam::SE3 z_up() {
  slam::SE3 T_world_map;
  T_world_map.rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return T_world_map;
}

std::string jpeg_message(std::int64_t time, std::string_view jpeg) {
  MessageWriter message;
  message.header(time, "camera");
  message.text("jpeg");
  message.byte_list(jpeg);
  return message.bytes();
}

std::string plan_message(std::int64_t time, const slam::OccupancyGrid& plan) {
  MessageWriter message;
  message.header(time, "plan");
  message.number(static_cast<std::int32_t>(0));  // when it was loaded: never
  message.number(static_cast<std::uint32_t>(0));
  message.number(static_cast<float>(plan.cell));
  message.number(static_cast<std::uint32_t>(plan.cells.width()));
  message.number(static_cast<std::uint32_t>(plan.cells.height()));
  put_pose(message, {Eigen::Matrix3d::Identity(), {plan.origin.x(), plan.origin.y(), 0.0}});
  std::string cells;  // from the lower left corner on: 0 free, 100 blocked, -1 unknown
  for (int y = plan.cells.height() - 1; y >= 0; --y) {
    for (int x = 0; x < plan.cells.width(); ++x) {
      const std::uint8_t kind = plan.cells.at(x, y);
      cells += static_cast<char>(kind == slam::OccupancyGrid::kFree      ? 0
                                 : kind == slam::OccupancyGrid::kBlocked ? 100
                                                                         : -1);
    }
  }
  message.byte_list(cells);
  return message.bytes();
}

std::int64_t nanoseconds_of(double seconds) { return std::llround(seconds * 1e9); }

}  // namespace penumbra::apps
