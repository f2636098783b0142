// penumbra export: a run's results in the formats of other programs.

#include <fmt/core.h>

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "apps/common/commands.h"
#include "apps/slam/run_messages.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/map/ply.h"
#include "slam/sources/bag/mcap_writer.h"

namespace penumbra::apps {

namespace {

constexpr const char* kExportExamples = R"(Examples:
  penumbra export out/00 --mcap out/00.mcap          for Foxglove and ros2 bag
  penumbra export out/00 --pcd out/00.pcd            the map's points for the Point Cloud Library

MCAP, messages of ROS 2: /pose (geometry_msgs/PoseStamped), /path (nav_msgs/Path), /map (sensor_msgs/PointCloud2: points,
keyframes in red), /overlay (sensor_msgs/CompressedImage: keyframes with their features and objects), /plan
(nav_msgs/OccupancyGrid, of runs with --dense), /tf and /tf_static (world, z up; map; camera; plan). PCD: x y z rgb.)";

struct ExportOptions {
  std::string run, mcap, pcd;
};

namespace fs = std::filesystem;

nlohmann::json read_json(const fs::path& path) {
  nlohmann::json json = nlohmann::json::parse(nn::read_text_file(path, "a run's file"), nullptr, false);
  if (json.is_discarded()) throw InputError(path.string(), "JSON of `penumbra slam`", "something else");
  return json;
}

// The keyframes' pictures by their times; none where a run has none, as of streams.
std::map<std::int64_t, fs::path> overlays_of(const fs::path& folder) {
  std::map<std::int64_t, fs::path> overlays;
  if (!fs::is_directory(folder / "gallery") || !fs::exists(folder / "frames.json")) return overlays;
  const nlohmann::json frames = read_json(folder / "frames.json");
  for (std::size_t i = 0; i < frames.value("index", nlohmann::json::array()).size(); ++i) {
    const fs::path picture = folder / "gallery" / fmt::format("{:06}.jpg", frames["index"][i].get<int>());
    if (fs::exists(picture)) overlays[nanoseconds_of(frames["timestamp"].at(i).get<double>())] = picture;
  }
  return overlays;
}

// The plan of a run with --dense, and where it lies.
std::optional<slam::OccupancyGrid> plan_of(const fs::path& folder) {
  if (!fs::exists(folder / "plan.yaml")) return std::nullopt;
  const nlohmann::json run = read_json(folder / "run.json");
  const auto rows = run.value("/dense/plan_from_map"_json_pointer, std::vector<std::vector<double>>());
  if (rows.size() != 3) return std::nullopt;
  slam::OccupancyGrid plan = slam::read_occupancy(folder / "plan.yaml");
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      plan.T_plan_world.rotation(row, column) =
          rows[static_cast<std::size_t>(row)].at(static_cast<std::size_t>(column));
    plan.T_plan_world.translation[row] = rows[static_cast<std::size_t>(row)].at(3);
  }
  return plan;
}

void write_run_mcap(const fs::path& path, const fs::path& run, const std::vector<slam::PlyVertex>& points) {
  const slam::Trajectory poses = slam::read_tum_trajectory(run / "trajectory_tum.txt");
  slam::McapWriter writer(path);
  const auto channel = [&](const char* topic, const MessageType& type) {
    return writer.add_channel(topic, type.name, type.definition);
  };
  const std::uint16_t fixed = channel("/tf_static", kTransforms), moving = channel("/tf", kTransforms);
  const std::uint16_t pose = channel("/pose", kPoseStamped), way = channel("/path", kPath);
  const std::uint16_t map = channel("/map", kPointCloud2), overlay = channel("/overlay", kCompressedImage);
  // Map and path stand at the beginning, so that they are seen all along.
  const std::int64_t begin = nanoseconds_of(poses.front().timestamp);
  writer.write(fixed, begin, world_transform_message(begin));
  writer.write(map, begin, cloud_message(begin, points));
  writer.write(way, begin, path_message(begin, poses));
  if (const std::optional<slam::OccupancyGrid> plan = plan_of(run)) {
    writer.write(fixed, begin, plan_transform_message(begin, *plan));
    writer.write(channel("/plan", kOccupancyGrid), begin, plan_message(begin, *plan));
  }
  const std::map<std::int64_t, fs::path> overlays = overlays_of(run);
  for (const slam::TimedPose& at : poses) {
    const std::int64_t time = nanoseconds_of(at.timestamp);
    if (const auto picture = overlays.find(time); picture != overlays.end())
      writer.write(overlay, time, jpeg_message(time, nn::read_file(picture->second, "a JPEG")));
    writer.write(pose, time, pose_message(time, at.T_wc));
    writer.write(moving, time, camera_transform_message(time, at.T_wc));
  }
  writer.finish();
}

void export_run(const ExportOptions& options) {
  if (options.mcap.empty() && options.pcd.empty())
    throw UsageError("export: expected --mcap FILE or --pcd FILE");
  const fs::path folder = options.run;
  const std::vector<slam::PlyVertex> points = slam::read_ply(folder / "map.ply");
  if (!options.mcap.empty()) {
    write_run_mcap(options.mcap, folder, points);
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
