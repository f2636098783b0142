// penumbra export: a run's results in the formats of other programs.

#include <fmt/core.h>

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/run_json.h"
#include "apps/slam/run_messages.h"
#include "apps/view/keyframe_gallery.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/geometry/mounting.h"
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
(nav_msgs/OccupancyGrid, of runs with --dense), /tf and /tf_static (world, z up; map; camera; plan). Of a run with --body
poses and path are the body's, and the camera hangs on it. PCD: x y z rgb.)";

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

// Rows of [R t] in run.json; nothing where they are not there.
std::optional<slam::SE3> motion_in(const fs::path& run_json, const char* pointer) {
  const nlohmann::json run = read_run_json(run_json);
  const nlohmann::json::json_pointer place(pointer);
  if (!run.contains(place)) return std::nullopt;
  std::array<std::array<double, 4>, 3> rows{};
  try {
    run.at(place).get_to(rows);
  } catch (const nlohmann::json::exception&) {
    throw InputError(run_json.string(), fmt::format("{}: three rows of four numbers", pointer),
                     run.at(place).dump());
  }
  slam::SE3 T;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const auto i = static_cast<Eigen::Index>(row);
    T.rotation.row(i) = Eigen::Map<const Eigen::RowVector3d>(rows[row].data());
    T.translation[i] = rows[row][3];
  }
  return T;
}

// The plan of a run with --dense, and where it lies.
std::optional<slam::OccupancyGrid> plan_of(const fs::path& folder) {
  if (!fs::exists(folder / "plan.yaml")) return std::nullopt;
  const std::optional<slam::SE3> T_plan_map = motion_in(folder / "run.json", "/dense/plan_from_map");
  if (!T_plan_map) return std::nullopt;
  slam::OccupancyGrid plan = slam::read_occupancy(folder / "plan.yaml");
  plan.T_plan_world = *T_plan_map;
  return plan;
}

// The body of a run with --body.
std::optional<slam::Mounting> body_of(const fs::path& folder) {
  if (!fs::exists(folder / "run.json")) return std::nullopt;
  const std::optional<slam::SE3> T_body_camera = motion_in(folder / "run.json", "/body/body_from_camera");
  if (!T_body_camera) return std::nullopt;
  std::string frame = read_run_json(folder / "run.json").at("body").value("frame", "body");
  for (const char* own : {"world", "map", "camera", "plan"}) {
    if (frame == own) frame += "_body";
  }
  return slam::Mounting{frame, *T_body_camera};
}

// What moves: the camera on the map, or the body, on which the camera stands.
Transform moved(const std::optional<slam::Mounting>& body, const slam::SE3& T_wc) {
  if (!body) return {"map", "camera", T_wc};
  return {"map", body->frame, T_wc * body->T_frame_camera.inverse()};
}

// What stands still.
std::vector<Transform> fixed_of(const std::optional<slam::Mounting>& body,
                                const std::optional<slam::OccupancyGrid>& plan) {
  std::vector<Transform> fixed = {{"world", "map", body ? body->T_frame_camera : z_up()}};
  if (body) fixed.push_back({body->frame, "camera", body->T_frame_camera});
  if (plan) fixed.push_back({"map", "plan", plan->T_plan_world.inverse()});
  return fixed;
}

void write_run_mcap(const fs::path& path, const fs::path& run, const std::vector<slam::PlyVertex>& points) {
  const std::optional<slam::Mounting> body = body_of(run);
  const std::optional<slam::OccupancyGrid> plan = plan_of(run);
  const char* const frame = body ? "world" : "map";  // of poses
  const slam::Trajectory poses = slam::read_tum_trajectory(run / "trajectory_tum.txt");
  slam::McapWriter writer(path);
  const auto channel = [&](const char* topic, const MessageType& type,
                           slam::Offered offered = slam::Offered::as_it_comes) {
    return writer.add_channel(topic, type.name, type.definition, offered);
  };
  const std::uint16_t fixed = channel("/tf_static", kTransforms, slam::Offered::to_late_comers),
                      moving = channel("/tf", kTransforms);
  const std::uint16_t pose = channel("/pose", kPoseStamped),
                      way = channel("/path", kPath, slam::Offered::to_late_comers);
  const std::uint16_t map = channel("/map", kPointCloud2, slam::Offered::to_late_comers),
                      overlay = channel("/overlay", kCompressedImage);
  // Map and path stand at the beginning, so that they are seen all along.
  const std::int64_t begin = nanoseconds_of(poses.front().timestamp);
  writer.write(fixed, begin, transforms_message(begin, fixed_of(body, plan)));
  writer.write(map, begin, cloud_message(begin, points));
  writer.write(way, begin, path_message(begin, frame, body ? slam::poses_of_body(*body, poses) : poses));
  if (plan) {
    writer.write(channel("/plan", kOccupancyGrid, slam::Offered::to_late_comers), begin,
                 plan_message(begin, *plan));
  }
  const std::map<std::int64_t, fs::path> overlays = overlays_of(run);
  for (const slam::TimedPose& at : poses) {
    const std::int64_t time = nanoseconds_of(at.timestamp);
    if (const auto picture = overlays.find(time); picture != overlays.end())
      writer.write(overlay, time, jpeg_message(time, nn::read_file(picture->second, "a JPEG")));
    writer.write(pose, time, pose_message(time, frame, body ? slam::pose_of_body(*body, at.T_wc) : at.T_wc));
    writer.write(moving, time, transforms_message(time, {moved(body, at.T_wc)}));
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
