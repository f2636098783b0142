#include "apps/evaluate/evaluation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "nn/base/counted.h"

namespace penumbra::apps {

namespace {

using nlohmann::ordered_json;
using slam::ErrorStatistics;
using slam::SegmentDrift;

void append_statistics(std::string& text, const std::string& name, const ErrorStatistics& s) {
  if (s.count == 0) {
    fmt::format_to(std::back_inserter(text), "{:<24} the path is too short for two such steps\n", name);
    return;
  }
  fmt::format_to(std::back_inserter(text),
                 "{:<24}{:>10.4f}{:>10.4f}{:>10.4f}{:>10.4f}{:>10.4f}{:>10.4f}{:>8}\n", name, s.rmse, s.mean,
                 s.median, s.std, s.min, s.max, s.count);
}

void append_drift(std::string& text, const std::string& name, const SegmentDrift& drift) {
  if (drift.count == 0) {
    fmt::format_to(std::back_inserter(text), "{:<24}{:>10}{:>10}{:>8}\n", name, "-", "-", 0);
    return;
  }
  fmt::format_to(std::back_inserter(text), "{:<24}{:>10.4f}{:>10.4f}{:>8}\n", name, drift.translation,
                 drift.rotation, drift.count);
}

ordered_json statistics_json(const ErrorStatistics& s) {
  if (s.count == 0) return nullptr;
  return {{"count", s.count}, {"rmse", s.rmse}, {"mean", s.mean}, {"median", s.median},
          {"std", s.std},     {"min", s.min},   {"max", s.max},   {"sse", s.sse}};
}

ordered_json drift_json(const SegmentDrift& drift) {
  const bool known = drift.count > 0;
  return {{"segments", drift.count},
          {"t_rel_percent", known ? ordered_json(drift.translation) : ordered_json(nullptr)},
          {"r_rel_deg_per_100m", known ? ordered_json(drift.rotation) : ordered_json(nullptr)}};
}

std::string frames_name(int frames) { return counted(frames, "frame"); }

}  // namespace

std::string evaluation_table(const slam::Evaluation& evaluation, const slam::EvaluationOptions& options) {
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{}, path of {:.1f} m, alignment {}", counted(evaluation.poses, "pose"),
                 evaluation.kitti.path_length, to_string(options.alignment));
  if (options.alignment == slam::Alignment::sim3)
    fmt::format_to(out, " (scale {:.6f})", evaluation.alignment.scale);
  fmt::format_to(out, "\n\n{:<24}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>8}\n", "", "rmse", "mean", "median",
                 "std", "min", "max", "count");
  append_statistics(text, "APE (m)", evaluation.ape);
  const std::string frames = "RPE " + frames_name(options.rpe_frames);
  append_statistics(text, frames + " (m)", evaluation.rpe_frames);
  append_statistics(text, frames + " (deg)", evaluation.rpe_frames_rotation);
  const std::string metres = fmt::format("RPE {:g} m", options.rpe_metres);
  append_statistics(text, metres + " (m)", evaluation.rpe_metres);
  append_statistics(text, metres + " (deg)", evaluation.rpe_metres_rotation);

  const slam::KittiMetrics& kitti = evaluation.kitti;
  fmt::format_to(out, "\n{:<24}{:>10}{:>10}{:>8}\n", "KITTI drift", "t_rel %", "deg/100 m", "count");
  if (kitti.overall.count == 0) {
    fmt::format_to(
        out, "the path of {:.1f} m is shorter than every segment ({:g} m and more): choose --segments\n",
        kitti.path_length, *std::min_element(options.segment_lengths.begin(), options.segment_lengths.end()));
    return text;
  }
  for (const SegmentDrift& drift : kitti.by_length) {
    append_drift(text, fmt::format("segments of {:g} m", drift.length), drift);
  }
  append_drift(text, "all segments", kitti.overall);
  return text;
}

ordered_json evaluation_json(const slam::Evaluation& evaluation, const slam::EvaluationOptions& options) {
  const slam::Similarity& alignment = evaluation.alignment;
  ordered_json rotation = ordered_json::array();
  for (int row = 0; row < 3; ++row) {
    rotation.push_back({alignment.rotation(row, 0), alignment.rotation(row, 1), alignment.rotation(row, 2)});
  }
  ordered_json kitti = drift_json(evaluation.kitti.overall);
  kitti["by_length"] = ordered_json::array();
  for (const SegmentDrift& drift : evaluation.kitti.by_length) {
    ordered_json entry = {{"length_m", drift.length}};
    entry.update(drift_json(drift));
    kitti["by_length"].push_back(entry);
  }
  return {
      {"poses", evaluation.poses},
      {"path_length_m", evaluation.kitti.path_length},
      {"alignment",
       {{"mode", to_string(options.alignment)},
        {"is_unique", alignment.is_unique},
        {"scale", alignment.scale},
        {"rotation", rotation},
        {"translation", {alignment.translation.x(), alignment.translation.y(), alignment.translation.z()}}}},
      {"ape_m", statistics_json(evaluation.ape)},
      {"rpe_frames",
       {{"frames", options.rpe_frames},
        {"translation_m", statistics_json(evaluation.rpe_frames)},
        {"rotation_deg", statistics_json(evaluation.rpe_frames_rotation)}}},
      {"rpe_metres",
       {{"metres", options.rpe_metres},
        {"translation_m", statistics_json(evaluation.rpe_metres)},
        {"rotation_deg", statistics_json(evaluation.rpe_metres_rotation)}}},
      {"kitti", kitti}};
}

}  // namespace penumbra::apps
