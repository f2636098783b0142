// penumbra eval: how far an estimated trajectory is from the ground truth.

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "apps/evaluation_report.h"
#include "nn/base/error.h"
#include "nn/io/image_file.h"
#include "slam/datasets/frame_range.h"
#include "slam/evaluation/association.h"
#include "slam/evaluation/trajectory_plot.h"
#include "slam/geometry/trajectory_io.h"

namespace penumbra::apps {

namespace {

constexpr const char* kEvalExamples = R"(Examples:
  penumbra eval --groundtruth poses/00.txt --estimate out/trajectory_kitti.txt
  penumbra eval --groundtruth poses/00.txt --frames 0:100 --estimate out/trajectory_kitti.txt --segments 10,20,30,40,50
  penumbra eval --groundtruth groundtruth.txt --estimate trajectory_tum.txt --align sim3 --json
  penumbra eval --groundtruth poses/00.txt --estimate a.txt --plot a.png

The numbers are those of evo (evo_ape, evo_rpe) and of the KITTI development kit; see docs/evaluation.md.)";

struct EvalOptions {
  std::string ground_truth, estimate;
  std::string format = "auto", alignment = "se3", frames, plot;
  double max_time_difference = slam::kMaxTimeDifference;
  slam::EvaluationOptions evaluation;
  bool json = false;
};

slam::TrajectoryFormat find_format(const EvalOptions& options) {
  if (options.format == "kitti") return slam::TrajectoryFormat::kitti;
  if (options.format == "tum") return slam::TrajectoryFormat::tum;
  const slam::TrajectoryFormat truth = slam::detect_trajectory_format(options.ground_truth);
  const slam::TrajectoryFormat estimate = slam::detect_trajectory_format(options.estimate);
  if (truth != estimate) {
    throw UsageError(fmt::format("the ground truth is in {} format and the estimate in {}: give both in one",
                                 to_string(truth), to_string(estimate)));
  }
  return truth;
}

// KITTI files carry no times: line i of the estimate belongs to line i of the (part of the) ground truth.
slam::TrajectoryPair pair_by_line(const EvalOptions& options) {
  const slam::Trajectory truth = slam::read_kitti_trajectory(options.ground_truth);
  slam::TrajectoryPair pair{truth, slam::read_kitti_trajectory(options.estimate)};
  if (!options.frames.empty()) {
    const slam::FrameRange range = slam::parse_frame_range(options.frames);
    const auto first = truth.begin() + range.begin;
    const int size = range.size(static_cast<int>(truth.size()), options.ground_truth);
    pair.reference.assign(first, first + size);
  }
  if (pair.reference.size() != pair.estimate.size()) {
    throw InputError(options.estimate,
                     fmt::format("{} poses as in {}{}", pair.reference.size(), options.ground_truth,
                                 options.frames.empty() ? "" : " " + options.frames),
                     fmt::format("{} (--frames A:B picks a part of the ground truth)", pair.estimate.size()));
  }
  return pair;
}

slam::TrajectoryPair pair_by_time(const EvalOptions& options) {
  if (!options.frames.empty()) {
    throw UsageError("--frames is for KITTI files: TUM trajectories are paired by their times");
  }
  const slam::Trajectory truth = slam::read_tum_trajectory(options.ground_truth);
  const slam::Trajectory estimate = slam::read_tum_trajectory(options.estimate);
  slam::TrajectoryPair pair = slam::associate_by_time(truth, estimate, options.max_time_difference);
  spdlog::info("{} of {} estimated poses have a ground truth within {:g} s", pair.estimate.size(),
               estimate.size(), options.max_time_difference);
  return pair;
}

void write_plot(const EvalOptions& options, const slam::TrajectoryPair& pair,
                const slam::Evaluation& evaluation, slam::TrajectoryFormat format) {
  slam::TrajectoryPlotOptions plot;
  plot.title = "Estimate against ground truth";
  plot.subtitle =
      fmt::format("top view, {} poses, {:.1f} m, APE {:.3f} m rmse (alignment {})", evaluation.poses,
                  evaluation.kitti.path_length, evaluation.ape.rmse, options.alignment);
  plot.plane = format == slam::TrajectoryFormat::kitti ? slam::PlotPlane::xz : slam::PlotPlane::xy;
  nn::write_image(options.plot, slam::draw_trajectories(evaluation.aligned_estimate, pair.reference, plot));
}

void run_eval(EvalOptions options) {
  options.evaluation.alignment = slam::parse_alignment(options.alignment);
  const slam::TrajectoryFormat format = find_format(options);
  const slam::TrajectoryPair pair =
      format == slam::TrajectoryFormat::kitti ? pair_by_line(options) : pair_by_time(options);
  const slam::Evaluation evaluation =
      slam::evaluate_trajectory(pair.reference, pair.estimate, options.evaluation);
  if (!evaluation.alignment.is_unique) {
    spdlog::warn(
        "the path is straight or does not move: of the alignments that fit equally, the smallest turn is "
        "used");
  }
  if (!options.plot.empty()) write_plot(options, pair, evaluation, format);
  if (options.json) {
    fmt::print("{}\n", evaluation_json(evaluation, options.evaluation).dump(2));
  } else {
    fmt::print("{}", evaluation_table(evaluation, options.evaluation));
  }
}

}  // namespace

void add_eval_command(CLI::App& app) {
  const auto options = std::make_shared<EvalOptions>();
  CLI::App* command = app.add_subcommand(
      "eval", "Compare an estimated trajectory with the ground truth: APE, RPE, KITTI drift");
  command->footer(kEvalExamples);
  command->add_option("--groundtruth", options->ground_truth, "ground truth poses, KITTI or TUM format")
      ->required();
  command->add_option("--estimate", options->estimate, "estimated poses, same format")->required();
  command->add_option("--format", options->format, "auto looks at the number of columns")
      ->check(CLI::IsMember({"auto", "kitti", "tum"}))
      ->capture_default_str();
  command
      ->add_option("--align", options->alignment,
                   "what may be fitted first: nothing, a rigid motion, a similarity")
      ->check(CLI::IsMember({"none", "se3", "sim3"}))
      ->capture_default_str();
  command->add_option(
      "--frames", options->frames,
      "A:B, the lines of the ground truth (from 0, B excluded) that the estimate covers; KITTI only");
  command
      ->add_option("--segments", options->evaluation.segment_lengths,
                   "lengths of the KITTI drift's segments in metres (default 100,200,...,800)")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  command->add_option("--rpe-frames", options->evaluation.rpe_frames, "step of the RPE in frames")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--rpe-metres", options->evaluation.rpe_metres, "step of the RPE in metres")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--max-time-difference", options->max_time_difference,
                   "seconds between poses that belong together; TUM only")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--plot", options->plot, "also draw both paths from above into this .png or .jpg");
  command->add_flag("--json", options->json, "print JSON instead of tables");
  command->callback([options] { run_eval(*options); });
}

}  // namespace penumbra::apps
