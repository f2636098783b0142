// penumbra eval: how far an estimated trajectory is from the ground truth.

#include <fmt/core.h>

#include <cstdio>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/finite_number.h"
#include "apps/common/log.h"
#include "apps/common/parses_as.h"
#include "apps/evaluate/evaluation_report.h"
#include "apps/evaluate/trajectory_pairing.h"
#include "nn/base/counted.h"
#include "slam/evaluation/trajectory_plot.h"
#include "slam/sources/frame_range.h"

namespace penumbra::apps {

namespace {

constexpr const char* kEvalExamples = R"(Examples:
  penumbra eval --groundtruth poses/00.txt --estimate out/trajectory_kitti.txt
  penumbra eval --groundtruth poses/00.txt --frames 0:100 --estimate out/trajectory_kitti.txt --segments 10,20,30,40,50
  penumbra eval --groundtruth groundtruth.txt --estimate trajectory_tum.txt --align sim3 --json
  penumbra eval --groundtruth poses/00.txt --estimate a.txt --plot a.svg

The numbers are those of evo (evo_ape, evo_rpe) and of the KITTI development kit; see docs/evaluation.md.)";

struct EvalOptions {
  PairingOptions pairing;
  std::string alignment = "se3", plot;
  slam::EvaluationOptions evaluation;
  bool json = false;
};

void write_plot(const EvalOptions& options, const slam::TrajectoryPair& pair,
                const slam::Evaluation& evaluation, slam::TrajectoryFormat format) {
  slam::TrajectoryPlotOptions plot;
  plot.title = "Estimate against ground truth";
  plot.subtitle = fmt::format("top view, {}, {:.1f} m, APE {:.3f} m rmse (alignment {})",
                              counted(evaluation.poses, "pose"), evaluation.kitti.path_length,
                              evaluation.ape.rmse, options.alignment);
  plot.plane = format == slam::TrajectoryFormat::kitti ? slam::PlotPlane::xz : slam::PlotPlane::xy;
  slam::write_plot(options.plot, slam::draw_trajectories(evaluation.aligned_estimate, pair.reference, plot));
}

void run_eval(EvalOptions options) {
  options.evaluation.alignment = slam::parse_alignment(options.alignment);
  const PairedTrajectories paired = pair_trajectories(options.pairing);
  check_pair_count(paired, options.evaluation.alignment);
  const slam::TrajectoryPair& pair = paired.pair;
  const slam::Evaluation evaluation =
      slam::evaluate_trajectory(pair.reference, pair.estimate, options.evaluation);
  if (!evaluation.alignment.is_unique) {
    log_warning(
        "the path is straight or does not move: of the alignments that fit equally, the smallest turn is "
        "used");
  }
  if (options.json) {
    fmt::print("{}\n", evaluation_json(evaluation, options.evaluation).dump(2));
  } else {
    fmt::print("{}", evaluation_table(evaluation, options.evaluation));
  }
  std::fflush(stdout);  // the numbers are out, whatever happens to the picture
  if (!options.plot.empty()) write_plot(options, pair, evaluation, paired.format);
}

}  // namespace

void add_eval_command(CLI::App& app) {
  const auto options = std::make_shared<EvalOptions>();
  CLI::App* command = app.add_subcommand(
      "eval", "Compare an estimated trajectory with the ground truth: APE, RPE, KITTI drift");
  command->footer(kEvalExamples);
  PairingOptions& pairing = options->pairing;
  constexpr double kMost = std::numeric_limits<double>::max();
  command
      ->add_option("--groundtruth", pairing.ground_truth,
                   "ground truth poses: KITTI, TUM, EuRoC (csv) or TartanAir format")
      ->required();
  command->add_option("--estimate", pairing.estimate, "estimated poses, in any of these formats")->required();
  command
      ->add_option("--format", pairing.format, "auto looks at the names of the columns, else at their number")
      ->check(CLI::IsMember({"auto", "kitti", "tum", "euroc", "tartanair"}))
      ->capture_default_str();
  command
      ->add_option("--align", options->alignment,
                   "what may be fitted first: nothing, a rigid motion, a similarity")
      ->check(CLI::IsMember({"none", "se3", "sim3"}))
      ->capture_default_str();
  command
      ->add_option("--frames", pairing.frames,
                   "the lines of the ground truth (from 0, B excluded) that the estimate covers; KITTI only")
      ->check(parses_as(slam::parse_frame_range))
      ->type_name("A:B");
  command
      ->add_option("--segments", options->evaluation.segment_lengths,
                   "lengths of the KITTI drift's segments in metres (default 100,200,...,800)")
      ->delimiter(',')
      ->check(number_above_zero());
  command->add_option("--rpe-frames", options->evaluation.rpe_frames, "step of the RPE in frames")
      ->check(number_above_zero())
      ->capture_default_str();
  command->add_option("--rpe-metres", options->evaluation.rpe_metres, "step of the RPE in metres")
      ->check(number_above_zero())
      ->capture_default_str();
  command
      ->add_option("--max-time-difference", pairing.max_time_difference,
                   "seconds between poses that belong together; files with times only")
      ->check(number_from(0.0, kMost, "seconds from 0"))
      ->capture_default_str();
  command
      ->add_option("--time-offset", pairing.time_offset,
                   "seconds to add to the estimate's times before they are compared")
      ->check(number_from(-kMost, kMost, "a finite number"));
  command->add_option("--plot", options->plot,
                      "also draw both paths from above into this .svg, .png or .jpg");
  command->add_flag("--json", options->json, "print JSON instead of tables");
  command->callback([options] { run_eval(*options); });
}

}  // namespace penumbra::apps
