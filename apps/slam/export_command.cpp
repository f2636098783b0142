// penumbra export: a run's results in the formats of other programs.

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>

#include "apps/common/commands.h"
#include "apps/slam/run_messages.h"
#include "nn/base/error.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/map/ply.h"
#include "slam/sources/bag/mcap_writer.h"

namespace penumbra::apps {

namespace {

constexpr const char* kExportExamples = R"(Examples:
  penumbra export out/00 --mcap out/00.mcap          for Foxglove and ros2 bag
  penumbra export out/00 --pcd out/00.pcd            the map's points for the Point Cloud Library

MCAP, messages of ROS 2: /pose (geometry_msgs/PoseStamped), /path (nav_msgs/Path), /map (sensor_msgs/PointCloud2: points,
keyframes in red), /tf and /tf_static (world, z up; map; camera). PCD: x y z rgb.)";

struct ExportOptions {
  std::string run, mcap, pcd;
};

void write_run_mcap(const std::filesystem::path& path, const slam::Trajectory& poses,
                    const std::vector<slam::PlyVertex>& points) {
  slam::McapWriter writer(path);
  const auto channel = [&](const char* topic, const MessageType& type) {
    return writer.add_channel(topic, type.name, type.definition);
  };
  const std::uint16_t fixed = channel("/tf_static", kTransforms), moving = channel("/tf", kTransforms);
  const std::uint16_t pose = channel("/pose", kPoseStamped), way = channel("/path", kPath);
  const std::uint16_t map = channel("/map", kPointCloud2);
  // Map and path stand at the beginning, so that they are seen all along.
  const std::int64_t begin = nanoseconds_of(poses.front().timestamp);
  writer.write(fixed, begin, world_transform_message(begin));
  writer.write(map, begin, cloud_message(begin, points));
  writer.write(way, begin, path_message(begin, poses));
  for (const slam::TimedPose& at : poses) {
    const std::int64_t time = nanoseconds_of(at.timestamp);
    writer.write(pose, time, pose_message(time, at.T_wc));
    writer.write(moving, time, camera_transform_message(time, at.T_wc));
  }
  writer.finish();
}

void export_run(const ExportOptions& options) {
  if (options.mcap.empty() && options.pcd.empty())
    throw UsageError("export: expected --mcap FILE or --pcd FILE");
  const std::filesystem::path folder = options.run;
  const std::vector<slam::PlyVertex> points = slam::read_ply(folder / "map.ply");
  if (!options.mcap.empty()) {
    write_run_mcap(options.mcap, slam::read_tum_trajectory(folder / "trajectory_tum.txt"), points);
    fmt::print("{}\n", options.mcap);
  }
  if (!options.pcd.empty()) {
    slam::write_pcd(options.pcd, points);
    fmt::print("{}\n", options.pcd);
  }
}

}  // namespace

void add_export_command(CLI::App& app) {
  const auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand(
      "export", "Write a run of `penumbra slam` for Foxglove, ROS 2 or the Point Cloud Library");
  command->footer(kExportExamples);
  command->add_option("run", options->run, "folder that `penumbra slam --out` wrote")->required();
  command->add_option("--mcap", options->mcap, "poses, path and map as an MCAP file of ROS 2 messages")
      ->type_name("FILE");
  command->add_option("--pcd", options->pcd, "the map's points and keyframes as a PCD file")
      ->type_name("FILE");
  command->callback([options] { export_run(*options); });
}

}  // namespace penumbra::apps
