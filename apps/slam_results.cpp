#include "apps/slam_results.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <optional>

#include "apps/frames_report.h"
#include "apps/keyframe_gallery.h"
#include "nn/io/file.h"
#include "nn/io/image_file.h"
#include "slam/evaluation/association.h"
#include "slam/evaluation/trajectory_plot.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/map/ply.h"

namespace penumbra::apps {

namespace {

// Poses of the frames that were located.
slam::Trajectory located(const slam::Slam& slam) {
  slam::Trajectory all = slam.trajectory(), located;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (slam.results()[i].tracking.state == slam::TrackingState::tracking) located.push_back(all[i]);
  }
  return located;
}

// Ground truth and estimate of the frames that have both, the ground truth moved so that it starts where the
// estimate starts.
slam::TrajectoryPair pair_with_ground_truth(const slam::StereoDataset& dataset,
                                            const slam::Trajectory& estimate) {
  slam::TrajectoryPair pair;
  if (!dataset.ground_truth()) return pair;
  std::size_t at = 0;
  for (const slam::TimedPose& pose : *dataset.ground_truth()) {  // with the frames' own times
    while (at < estimate.size() && estimate[at].timestamp < pose.timestamp) ++at;
    if (at == estimate.size()) break;
    if (estimate[at].timestamp != pose.timestamp) continue;
    pair.reference.push_back(pose);
    pair.estimate.push_back(estimate[at]);
  }
  if (pair.reference.empty()) return pair;
  const slam::SE3 moved = pair.estimate.front().T_wc * pair.reference.front().T_wc.inverse();
  for (slam::TimedPose& pose : pair.reference) pose.T_wc = moved * pose.T_wc;
  return pair;
}

std::optional<slam::Evaluation> evaluate(const slam::TrajectoryPair& pair) {
  if (pair.reference.size() < 2) return std::nullopt;
  slam::EvaluationOptions options;
  // Short pieces have no segment of a hundred metres.
  if (slam::path_length(pair.reference) < 200.0) options.segment_lengths = {10.0, 20.0, 30.0, 40.0, 50.0};
  return slam::evaluate_trajectory(pair.reference, pair.estimate, options);
}

}  // namespace

void write_results(const std::filesystem::path& out, const slam::StereoDataset& dataset,
                   const slam::Slam& slam, SlamRun& run) {
  const slam::Trajectory estimate = located(slam);
  const slam::TrajectoryPair pair = pair_with_ground_truth(dataset, estimate);
  const slam::Trajectory& truth = pair.reference;
  run.evaluation = evaluate(pair);
  if (!slam.results().empty()) {
    slam::write_kitti_poses(out / "trajectory_kitti.txt", slam.trajectory());
    slam::write_tum_trajectory(out / "trajectory_tum.txt", estimate);
    slam::write_tum_trajectory(out / "keyframes_tum.txt", slam.keyframe_trajectory());
    if (!truth.empty()) slam::write_tum_trajectory(out / "ground_truth_tum.txt", truth);
  }
  if (!estimate.empty()) {
    slam::TrajectoryPlotOptions plot;
    plot.title = dataset.name();
    nn::write_image(out / "trajectory.png", slam::draw_trajectories(estimate, truth, plot));
  }
  slam::write_ply(out / "map.ply", slam.map());
  write_keyframe_gallery(out / "gallery", dataset, slam);
  nn::write_file(out / "frames.json", frames_report(slam).dump() + "\n");
  nn::write_file(out / "run.json", to_text(slam_report(run, slam)));
}

void warn_of_pieces(const slam::Slam& slam) {
  const std::vector<slam::SubmapSummary> submaps = slam.submaps();
  for (std::size_t i = 1; i < submaps.size(); ++i) {
    if (submaps[i].frames == 0) continue;  // of a map that was loaded
    spdlog::warn(
        "frames {} to {}: the way was lost before and no place of the earlier map was seen since; these {} "
        "frames are right relative to each other, where they are is a guess",
        submaps[i].first_frame, submaps[i].last_frame, submaps[i].frames);
  }
}

void print_summary(const nlohmann::json& report, const std::filesystem::path& out) {
  fmt::print("{}: {} frames, {} tracked, {} lost, {} keyframes, {} map points, {:.1f} ms a frame (median)\n",
             report["dataset"].get<std::string>(), report["frames"].get<int>(), report["tracked"].get<int>(),
             report["lost"].get<int>(), report["keyframes"].get<int>(), report["map_points"].get<int>(),
             report.value("median_ms", 0.0));
  if (const double offset = report["disparity_offset_px"].get<double>(); offset != 0.0) {
    fmt::print("disparities are {:.2f} pixels too {} for the calibration, which was taken into account\n",
               std::abs(offset), offset > 0.0 ? "large" : "small");
  }
  if (report.contains("ground_truth")) {
    const nlohmann::json& truth = report["ground_truth"];
    fmt::print("against the ground truth ({:.1f} m): APE {:.3f} m rmse", truth["path_m"].get<double>(),
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
