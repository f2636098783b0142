#include "apps/brain/brain_results.h"

#include <fmt/core.h>

#include "apps/brain/brain_figures.h"
#include "apps/brain/brain_plots.h"
#include "apps/common/command_line.h"
#include "apps/common/result_writer.h"
#include "apps/view/run_truth.h"
#include "nn/base/file.h"
#include "nn/base/quantile.h"
#include "nn/image/image_file.h"
#include "slam/evaluation/trajectory_plot.h"
#include "slam/geometry/trajectory_io.h"

namespace penumbra::apps {

namespace {

nlohmann::json pose_json(const slam::brain::PlanePose& pose) {
  return {{"x", pose.x}, {"y", pose.y}, {"heading", pose.heading}};
}

nlohmann::json recall_json(const slam::brain::Recall& recall) {
  return {{"frame", recall.frame},         {"earlier_frame", recall.earlier_frame},
          {"node", recall.node},           {"similarity", recall.similarity},
          {"points", recall.inliers},      {"correction_m", recall.correction},
          {"of_loaded_map", recall.loaded}};
}

nlohmann::json truth_json(const slam::Evaluation& e) {
  nlohmann::json json = {{"ape_rmse_m", e.ape.rmse}, {"path_m", e.kitti.path_length}};
  if (e.kitti.overall.count > 0) {
    json["t_rel_percent"] = e.kitti.overall.translation;
    json["r_rel_deg_per_100m"] = e.kitti.overall.rotation;
  }
  return json;
}

nlohmann::json run_json(const slam::brain::Brain& brain, const slam::brain::BrainRecorder& record,
                        const BrainRun& run, const std::optional<slam::Evaluation>& settled,
                        const std::optional<slam::Evaluation>& believed) {
  nlohmann::json json = {{"dataset", run.dataset},
                         {"command", command_line()},
                         {"version", kVersion},
                         {"system", "brain"},
                         {"motion", run.motion},
                         {"templates", slam::brain::to_string(brain.memory().kind())},
                         {"frames", record.results().size()},
                         {"tracked", static_cast<int>(record.results().size()) - run.lost},
                         {"lost", run.lost},
                         {"keyframes", record.keyframes().size()},
                         {"nodes", brain.map().size()},
                         {"links", brain.map().links().size()},
                         {"loaded_nodes", brain.loaded_nodes()},
                         {"located", brain.is_located()},
                         {"map_mb", static_cast<double>(brain.bytes()) / 1e6},
                         {"cpu_seconds", run.cpu_seconds},
                         {"peak_rss_mb", run.peak_rss_mb},
                         {"warnings", run.warnings}};
  if (!run.error.empty()) json["error"] = run.error;
  const std::vector<double>& ms = record.milliseconds();
  if (!ms.empty()) {
    json["median_ms"] = quantile_of(ms, 0.5);
    json["p95_ms"] = quantile_of(ms, 0.95);
  }
  json["loops"] = nlohmann::json::array();
  for (const slam::FramePair& pair : recalled_pairs(record))
    json["loops"].push_back({pair.frame, pair.earlier});
  json["recognised_places"] = json["loops"];
  json["recalls"] = nlohmann::json::array();
  for (const slam::brain::Recall& recall : record.recalls()) json["recalls"].push_back(recall_json(recall));
  json["keyframe_frames"] = record.keyframes();
  json["covisibility"] = json["loops"];  // keyframes that show the same points
  if (settled) json["ground_truth"] = truth_json(*settled);
  if (believed) json["ground_truth_believed"] = truth_json(*believed);
  return json;
}

nlohmann::json frames_json(const slam::brain::BrainRecorder& record) {
  nlohmann::json json;
  for (const char* key : {"index", "timestamp", "ms", "keyframe", "anchor", "recalled", "filter"})
    json[key] = nlohmann::json::array();
  for (std::size_t i = 0; i < record.results().size(); ++i) {
    const slam::brain::BrainResult& result = record.results()[i];
    json["index"].push_back(result.frame);
    json["timestamp"].push_back(result.timestamp);
    json["ms"].push_back(record.milliseconds()[i]);
    json["keyframe"].push_back(result.keyframe);
    json["anchor"].push_back(result.anchor);
    json["recalled"].push_back(result.recall ? nlohmann::json(result.recall->node) : nlohmann::json());
    json["filter"].push_back(nullptr);
  }
  return json;
}

}  // namespace

nlohmann::json cognitive_map_json(const slam::brain::CognitiveMap& map,
                                  const slam::brain::TemplateMemory& memory) {
  nlohmann::json nodes = nlohmann::json::array(), links = nlohmann::json::array();
  for (int i = 0; i < map.size(); ++i) {
    const slam::brain::Node& node = map.node(i);
    nlohmann::json json = pose_json(node.pose);
    json["frame"] = node.frame;
    json["time"] = node.timestamp;
    json["strength"] = node.strength;
    if (memory.kind() == slam::brain::TemplateKind::landmarks)
      json["landmarks"] = memory.at(i).landmarks.size();
    nodes.push_back(std::move(json));
  }
  for (const slam::brain::Link& link : map.links()) {
    nlohmann::json json = pose_json(link.motion);
    json["from"] = link.from;
    json["to"] = link.to;
    json["recalled"] = link.recalled;
    links.push_back(std::move(json));
  }
  return {{"nodes", nodes}, {"links", links}};
}

BrainPaths paths_of(const slam::StereoDataset& dataset, const slam::brain::Brain& brain,
                    const slam::brain::BrainRecorder& record) {
  BrainPaths paths;
  paths.settled = record.trajectory(brain.map());
  paths.by_the_map = pair_with_ground_truth(dataset, paths.settled);
  if (brain.loaded_nodes() == 0) paths.at_the_time = pair_with_ground_truth(dataset, record.believed());
  return paths;
}

void draw_brain_run(ResultWriter& writer, const std::filesystem::path& out, const std::string& title,
                    const BrainPaths& paths, const slam::brain::CognitiveMap& map,
                    const slam::brain::BrainRecorder& record) {
  slam::TrajectoryPlotOptions plot;
  plot.title = title;
  writer.draw([&] {
    slam::write_plot(out / "trajectory.svg",
                     slam::draw_trajectories(paths.settled, paths.by_the_map.reference, plot));
  });
  plot.estimate_name = "as believed at the time";
  writer.draw([&] {
    slam::write_plot(out / "believed.svg",
                     slam::draw_trajectories(record.believed(), paths.at_the_time.reference, plot));
  });
  writer.draw([&] { slam::write_plot(out / "cognitive_map.svg", draw_cognitive_map(map)); });
  writer.draw([&] { nn::write_image(out / "places.png", draw_place_activity(map, record)); });
  if (paths.at_the_time.reference.size() >= 2) {
    std::vector<double> times;
    for (const slam::brain::BrainResult& result : record.results()) {
      if (result.recall) times.push_back(result.timestamp);
    }
    writer.draw([&] {
      slam::write_plot(out / "error.svg", draw_error_over_time(paths.at_the_time, paths.by_the_map, times));
    });
  } else {
    writer.draw([&] { std::filesystem::remove(out / "error.svg"); });
  }
}

nlohmann::json write_brain_results(const std::filesystem::path& out, const slam::StereoDataset& dataset,
                                   const slam::brain::Brain& brain, const slam::brain::BrainRecorder& record,
                                   const BrainRun& run, const std::filesystem::path& save_map) {
  const BrainPaths paths = paths_of(dataset, brain, record);
  const slam::Trajectory& settled = paths.settled;
  const slam::Trajectory& truth = paths.by_the_map.reference;
  const nlohmann::json json =
      run_json(brain, record, run, evaluate_run(paths.by_the_map), evaluate_run(paths.at_the_time));
  ResultWriter writer;
  writer.write([&] { slam::write_kitti_poses(out / "trajectory_kitti.txt", settled); });
  writer.write([&] { slam::write_tum_trajectory(out / "trajectory_tum.txt", settled); });
  writer.write([&] {
    nn::write_file(out / "cognitive_map.json",
                   cognitive_map_json(brain.map(), brain.memory()).dump(1) + "\n");
  });
  if (!save_map.empty()) writer.write([&] { slam::brain::write_cognitive_map(save_map, brain.stored()); });
  writer.write([&] { nn::write_file(out / "frames.json", frames_json(record).dump() + "\n"); });
  const auto truth_path = out / "ground_truth_tum.txt";
  writer.write([&] {
    if (truth.empty()) {
      std::filesystem::remove(truth_path);  // of an earlier run
    } else {
      slam::write_tum_trajectory(truth_path, truth);
    }
  });
  writer.write([&] { nn::write_file(out / "run.json", json.dump(2) + "\n"); });
  draw_brain_run(writer, out, run.dataset, paths, brain.map(), record);
  writer.throw_failures();
  return json;
}

}  // namespace penumbra::apps
