// The subcommands of `penumbra`, one file each: every function adds its command with options, examples and
// the callback that runs it. A command throws UsageError (exit code 2) or any other exception (exit code 1).
#pragma once

#include <CLI/CLI.hpp>

namespace penumbra::apps {

void add_slam_command(CLI::App& app);          // a stereo sequence to a trajectory and a map
void add_brain_command(CLI::App& app);         // the same by a cognitive map, as brains do
void add_segment_command(CLI::App& app);       // find object instances in images
void add_classify_command(CLI::App& app);      // name what images show
void add_synth_command(CLI::App& app);         // render a synthetic drive
void add_report_command(CLI::App& app);        // a run as one page to look at
void add_export_command(CLI::App& app);        // a run for other programs
void add_merge_command(CLI::App& app);         // many maps to one
void add_fleet_command(CLI::App& app);         // many recordings to one map, on a cluster
void add_ablate_command(CLI::App& app);        // what masks and filters are worth
void add_eval_masks_command(CLI::App& app);    // compare masks from depth with exact ones
void add_eval_command(CLI::App& app);          // compare a trajectory with the ground truth
void add_match_eval_command(CLI::App& app);    // compare feature matching
void add_eval_dense_command(CLI::App& app);    // compare a dense map with the truth
void add_eval_loops_command(CLI::App& app);    // compare a run's loops with the ground truth
void add_eval_coco_command(CLI::App& app);     // compare detections with the ground truth
void add_convert_command(CLI::App& app);       // checkpoints to safetensors
void add_info_command(CLI::App& app);          // list a checkpoint's tensors
void add_calibrate_command(CLI::App& app);     // prepare weights for 8-bit arithmetic
void add_calibration_command(CLI::App& app);   // what a camera's calibration file says
void add_bench_command(CLI::App& app);         // measure speed
void add_dynamics_benchmark(CLI::App& app);    // of `bench`: ways to leave out people, on synthetic offices
void add_brain_benchmark(CLI::App& app);       // of `bench`: the brain-inspired SLAM beside RatSLAM
void add_landmarks_command(CLI::App& brain);   // of `brain`: what of images a place is known by
void add_train_grid_command(CLI::App& brain);  // of `brain`: let grid cells learn

}  // namespace penumbra::apps
