// penumbra export: a run's results in the formats of other programs.

#include <fmt/core.h>

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "apps/common/commands.h"
#include "apps/common/run_json.h"
#include "apps/slam/run_messages.h"
#include "apps/view/keyframe_gallery.h"
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

// The keyframes' pictures by their times; none where a run has none, as of streams.
std::map<std::int64_t, fs::path> overlays_of(const fs::path& folder) {
  std::map<std::int64_t, fs::path> overlays;
  const std::map<int, fs::path> pictures = gallery_pictures(folder / "gallery");
  if (pictures.empty() || !fs::exists(folder / "frames.json")) return overlays;
  const nlohmann::json frames = read_run_json(folder / "frames.json");
  const auto list = [&](const char* key) {
    const auto found = frames.find(key);
    return found != frames.end() && found->is_array() ? *found : nlohmann::json::array();
  };
  const nlohmann::json numbers = list("index"), times = list("timestamp");
  for (std::size_t i = 0; i < numbers.size() && i < times.size(); ++i) {
    if (!numbers[i].is_number_integer() || !times[i].is_number()) continue;  // a torn file's
    const auto picture = pictures.find(numbers[i].get<int>());
    if (picture != pictures.end()) overlays[nanoseconds_of(times[i].get<double>())] = picture->second;
  }
  return overlays;
}

// The plan of a run with --dense, and where it lies.
std::optional<slam::OccupancyGrid> plan_of(const fs::path& folder) {
  if (!fs::exists(folder / "plan.yaml")) return std::nullopt;
  const nlohmann::json run = read_run_json(folder / "run.json");
  const auto place = "/dense/plan_from_map"_json_pointer;
  if (!run.contains(place)) return std::nullopt;
  std::array<std::array<double, 4>, 3> rows{};
  try {
    run.at(place).get_to(rows);
  } catch (const nlohmann::json::exception&) {
    throw InputError((folder / "run.json").string(), "dense.plan_from_map: three rows of four numbers",
                     run.at(place).dump());
  }
  slam::OccupancyGrid plan = slam::read_occupancy(folder / "plan.yaml");
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const auto i = static_cast<Eigen::Index>(row);
    plan.T_plan_world.rotation.row(i) = Eigen::Map<const Eigen::RowVector3d>(rows[row].data());
    plan.T_plan_world.translation[i] = rows[row][3];
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
