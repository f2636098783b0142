#include "apps/slam/slam_results.h"

#include <fmt/core.h>

#include <cmath>
#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/common/log.h"
#include "apps/common/result_writer.h"
#include "apps/view/frames_report.h"
#include "apps/view/keyframe_gallery.h"
#include "apps/view/run_truth.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/quantile.h"
#include "nn/image/image_file.h"
#include "slam/evaluation/trajectory_plot.h"
#include "slam/geometry/association.h"
#include "slam/geometry/trajectory_file.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/map/dense/cloud_files.h"
#include "slam/map/map_file.h"
#include "slam/map/ply.h"

namespace penumbra::apps {

namespace {

// Poses of the frames that were located.
slam::Trajectory located(const slam::KeptFrames& kept) {
  const slam::KeptFrames::Poses poses = kept.poses();
  slam::Trajectory located;
  for (const slam::KeptFrame& frame : kept.frames()) {
    if (frame.is_located()) located.push_back({frame.timestamp, poses.of(frame)});
  }
  return located;
}

std::filesystem::path checkpoint_of(const std::filesystem::path& map) { return map.string() + ".checkpoint"; }

void write_or_remove(const std::filesystem::path& file, const slam::Trajectory& trajectory) {
  if (trajectory.empty()) {
    std::filesystem::remove(file);
  } else {
    slam::write_tum_trajectory(file, trajectory);
  }
}

// Of the frames, as they are read from disk, without more memory for more of them.
void write_poses(const std::filesystem::path& file, slam::TrajectoryFormat format,
                 const slam::KeptFrames& kept, const slam::KeptFrames::Poses& poses,
                 const slam::Mounting* body = nullptr) {
  const bool lost_too = format == slam::TrajectoryFormat::kitti;
  slam::TrajectoryFile made(file, format);
  bool is_empty = true;
  for (const slam::KeptFrame& frame : kept.frames()) {
    if (!lost_too && !frame.is_located()) continue;
    const slam::SE3 T_wc = poses.of(frame);
    made.add({frame.timestamp, body != nullptr ? slam::pose_of_body(*body, T_wc) : T_wc});
    is_empty = false;
  }
  is_empty ? void(std::filesystem::remove(file)) : made.commit();
}

// What is written of a run, taken from it so that another thread may write it. Only where `map` is to be
// written, too, must nobody change that meanwhile.
struct RunData {
  RunData(const slam::Recorder& record, const SlamRun& run, const std::filesystem::path& folder)
      : out(folder),
        kept(record.kept()),
        poses(kept.poses()),
        body(run.body),
        report(to_text(slam_report(run, record))),
        keyframes(record.slam().keyframe_trajectory()),
        cloud(slam::point_cloud_of(record.slam().map())) {}

  std::filesystem::path out;
  slam::KeptFrames kept;
  slam::KeptFrames::Poses poses;
  std::optional<slam::Mounting> body;
  std::string report;  // run.json
  slam::Trajectory keyframes;
  slam::PointCloud cloud;
  slam::Trajectory truth;  // of the located frames
  const slam::Map* map = nullptr;
  std::filesystem::path map_file;
};

// All that a run has found. What it has not is not left there from an earlier run either.
void write_data(ResultWriter& writer, const RunData& run) {
  using Format = slam::TrajectoryFormat;
  const std::filesystem::path& out = run.out;
  writer.write([&] { write_poses(out / "trajectory_kitti.txt", Format::kitti, run.kept, run.poses); });
  writer.write([&] { write_poses(out / "trajectory_tum.txt", Format::tum, run.kept, run.poses); });
  writer.write([&] { write_or_remove(out / "keyframes_tum.txt", run.keyframes); });
  writer.write([&] { write_or_remove(out / "ground_truth_tum.txt", run.truth); });
  writer.write([&] {
    if (run.body) {
      write_poses(out / "body_tum.txt", Format::tum, run.kept, run.poses, &*run.body);
    } else {
      std::filesystem::remove(out / "body_tum.txt");
    }
  });
  writer.write([&] { nn::write_file(out / "run.json", run.report); });
  writer.write([&] { write_frames_report(out / "frames.json", run.kept); });
  if (run.map != nullptr) writer.write([&] { slam::write_map(run.map_file, *run.map); });
  writer.write([&] { slam::write_ply(out / "map.ply", run.cloud); });
}

// The dense map and what run.json says of it. What this run does not have is not left there from an earlier
// one.
void write_dense(ResultWriter& writer, const std::filesystem::path& out, slam::DenseMapper* dense,
                 slam::Sensor sensor, const slam::Recorder& record, SlamRun& run) {
  for (const char* name : {"dense.ply", "dense.pcd", "plan.pgm", "plan.yaml"}) {
    writer.draw([&] { std::filesystem::remove(out / name); });
  }
  if (dense == nullptr || dense->views() == 0) return;
  const slam::DenseMap map = dense->build(record);
  run.dense = dense_report(map, record.slam().settings().dense);
  writer.write([&] { slam::write_dense_ply(out / "dense.ply", map.voxels, map.classes); });
  writer.write([&] { slam::write_pcd(out / "dense.pcd", map.voxels); });
  if (map.plan) writer.write([&] { slam::write_occupancy(out / "plan", *map.plan); });
  if (const std::string doubt = plan_doubt(map, record.slam().settings().dense, sensor); !doubt.empty()) {
    run.warnings.push_back(doubt);
    log_warning("{}", doubt);
  }
}

}  // namespace

void prepare_places(const ResultPlaces& places) {
  // The map's place first: where it is none, no folder is made.
  const std::filesystem::path map_folder = places.save_map.parent_path();
  std::error_code error;
  if (!places.save_map.empty() && std::filesystem::is_directory(places.save_map, error))
    throw InputError(places.save_map.string(), "the name of a file for the map", "a folder");
  if (!map_folder.empty() && map_folder != places.out && !std::filesystem::is_directory(map_folder, error))
    throw InputError(map_folder.string(), "a folder for the map", "none");
  if (!places.out.empty()) nn::make_writable_folder(places.out);
  if (!places.save_map.empty()) nn::require_writable_folder(map_folder.empty() ? "." : map_folder);
}

void write_results(const ResultPlaces& places, const slam::StereoDataset& dataset,
                   const slam::Recorder& record, slam::DenseMapper* dense, SlamRun& run) {
  const std::filesystem::path& out = places.out;
  const slam::Trajectory estimate = located(record.kept());
  const slam::TrajectoryPair pair = pair_with_ground_truth(dataset, estimate);
  const slam::Trajectory& truth = pair.reference;
  run.evaluation =
      evaluate_run(run.body ? slam::TrajectoryPair{slam::poses_of_body(*run.body, pair.reference),
                                                   slam::poses_of_body(*run.body, pair.estimate)}
                            : pair);
  ResultWriter writer;
  write_dense(writer, out, dense, dataset.sensor(), record, run);
  RunData data(record, run, out);
  data.truth = truth;
  if (!places.save_map.empty()) {
    data.map = &record.slam().map();
    data.map_file = places.save_map;
  }
  write_data(writer, data);
  if (estimate.empty()) {
    writer.draw([&] { std::filesystem::remove(out / "trajectory.svg"); });
  } else {
    slam::TrajectoryPlotOptions plot;
    plot.title = dataset.name();
    writer.draw(
        [&] { slam::write_plot(out / "trajectory.svg", slam::draw_trajectories(estimate, truth, plot)); });
  }
  if (dataset.size() > 0) {
    writer.draw([&] { write_keyframe_gallery(out / "gallery", dataset, record); });
  } else {  // a stream, whose frames are gone
    writer.draw([&] { clear_keyframe_gallery(out / "gallery"); });
  }
  writer.throw_failures();
  std::error_code none;
  if (!places.save_map.empty()) std::filesystem::remove(checkpoint_of(places.save_map), none);
}

std::function<void()> write_checkpoint(const ResultPlaces& places, const slam::Recorder& record,
                                       const SlamRun& run) {
  ResultWriter writer;
  if (!places.save_map.empty())
    writer.write([&] { slam::write_map(checkpoint_of(places.save_map), record.slam().map()); });
  return [writer, data = RunData(record, run, places.out)]() mutable {
    write_data(writer, data);
    // Pictures of an earlier run would not show what is written now.
    writer.draw([&] { std::filesystem::remove(data.out / "trajectory.svg"); });
    writer.draw([&] { clear_keyframe_gallery(data.out / "gallery"); });
    writer.throw_failures();
  };
}

std::string body_text(const slam::Mounting& body) {
  const Eigen::Vector3d& t = body.T_frame_camera.translation;
  return fmt::format(
      "poses of {} are written, too: in its frame the left camera is at {:.3f} {:.3f} {:.3f} m", body.frame,
      t.x(), t.y(), t.z());
}

void warn_of_pieces(const slam::Recorder& record) {
  const std::vector<slam::SubmapSummary> submaps = record.submaps();
  for (std::size_t i = 1; i < submaps.size(); ++i) {
    if (submaps[i].frames == 0) continue;  // of a map that was loaded
    log_warning(
        "frames {} to {}: the way was lost before and no place of the earlier map was seen since; {} there, "
        "right relative to each other, but where they are is a guess",
        submaps[i].first_frame, submaps[i].last_frame, counted(submaps[i].frames, "located frame"));
  }
}

// In half a second somebody walks half a metre: what is found of him then comes too late for the pose.
void warn_of_late_masks(const slam::Recorder& record, SlamRun& run) {
  constexpr double kLate = 0.5;  // seconds
  const std::vector<double>& delays = record.mask_delays().values();
  const double median = delays.empty() ? 0.0 : quantile_of(delays, 0.5);
  if (median <= kLate) return;
  run.warnings.push_back(
      fmt::format("masks came {:.2g} s late at the median: the network is too slow here for what moves fast "
                  "(a smaller one, --segmentation-threads, or --segmentation all, which waits)",
                  median));
  log_warning("{}", run.warnings.back());
}

void print_summary(const nlohmann::json& report, const std::filesystem::path& out) {
  const auto count_of = [&](const char* key, const char* one) {
    return counted(report[key].get<std::uint64_t>(), one);
  };
  fmt::print("{}: {}, {} tracked, {} lost, {}, {}, {:.1f} ms a frame (median)\n",
             report["dataset"].get<std::string>(), count_of("frames", "frame"), report["tracked"].get<int>(),
             report["lost"].get<int>(), count_of("keyframes", "keyframe"),
             count_of("map_points", "map point"), report.value("median_ms", 0.0));
  if (report["tracked"].get<int>() > 1) {
    fmt::print("{:.1f} m, {:.2f} m/s on average; features at {:.2g} m (median)\n",
               report["path_m"].get<double>(), report["mean_speed_mps"].get<double>(),
               report["median_depth_m"].get<double>());
  }
  if (const double offset = report["disparity_offset_px"].get<double>(); offset != 0.0) {
    fmt::print("disparities are {:.2f} pixels too {} for the calibration, which was taken into account\n",
               std::abs(offset), offset > 0.0 ? "large" : "small");
  }
  if (report.contains("masks_late_s")) {
    fmt::print("masks came {:.2f} s late at the median, {:.2f} s at most\n",
               report["masks_late_s"]["median"].get<double>(), report["masks_late_s"]["most"].get<double>());
  }
  if (report.contains("ground_truth")) {
    const nlohmann::json& truth = report["ground_truth"];
    const std::string of = report.contains("body") ? report["body"]["frame"].get<std::string>() + ", " : "";
    fmt::print("against the ground truth ({}{:.1f} m): APE {:.3f} m rmse", of, truth["path_m"].get<double>(),
               truth["ape_rmse_m"].get<double>());
    if (truth.contains("t_rel_percent")) {
      fmt::print(", drift {:.2f} % and {:.2f} deg/100 m", truth["t_rel_percent"].get<double>(),
                 truth["r_rel_deg_per_100m"].get<double>());
    }
    fmt::print("\n");
  }
  fmt::print("results in {}\n", out.string());
}

}  // namespace penumbra::apps
