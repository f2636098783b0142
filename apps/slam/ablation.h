// The ablation of the semantics: one synthetic drive or office, run with one combination of what the SLAM can
// use.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "nn/image/image.h"
#include "slam/dynamics/instance.h"

namespace penumbra::apps {

// What leaves features out, from nothing to the upper bound. In the office whatever can move is left out,
// unless geometry is asked for.
enum class MaskSource {
  none,                 // every feature is taken for the world's; nothing looks for movers
  movers,               // no masks, large rigid movers found by geometry alone
  classes,              // the network's masks; whatever can move is left out, as DynaSLAM does
  geometry,             // the network's masks; what geometry finds moving is left out
  boxes,                // whole boxes, of the network or exact
  clusters_unrepaired,  // what the depths in those boxes say (slam/dynamics/rgbd/depth_masks.h); of RGB-D
                        // alone
  clusters,             // the same with holes repaired first
  clusters_consistent,  // and what is seen to move, too
  dbscan,               // what the depths of the feature points in the boxes say (rgbd/dbscan_masks.h)
  static_boxes,         // whole boxes, of which points that stand still are given back (static_points.h)
  static_paper,         // dbscan, and points given back, both in the letter of the paper
  static_points,        // dbscan, and points given back
  static_masks,         // exact masks, of which points that stand still are given back
  truth,                // exact masks; on the street geometry decides what moves
};

MaskSource parse_mask_source(const std::string& name);  // UsageError for another name
std::string name_of(MaskSource source);

struct AblationCell {
  std::string preset;
  int seed = 1, frames = 0;
  Size size;  // of the images
  MaskSource masks = MaskSource::none;
  std::string weights;  // name of the network; empty where masks come from none
  std::string filter = "adaptive";
  bool all_frames = false;  // are segmented, before they are located; else keyframes
  int run = 0;              // 0: the only one, deterministic; else with all threads, as runs vary

  bool is_office() const;  // the preset is one of the office's
  std::string drive_name() const;
  std::string name() const;  // of its file
};

// Renders the cell's drive below `folder` unless it is there, whole, already.
std::filesystem::path render_drive(const AblationCell& cell, const std::filesystem::path& folder);

// Keys: ate_m, rpe_m (root mean squares; of the office's RPE over a second, else a frame), ate_mean_m,
// ate_median_m, ate_sd_m and the same of rpe, angle_deg, loops, loop_precision, loop_recall (of the
// keyframes, see slam/evaluation/loop_evaluation.h), tracked, lost, occluded, median_ms; of the office
// moving_recall, standing_kept (point_truth.h) and static_points_ms. `weights`: file of the cell's network;
// empty: exact boxes and masks. `pictures`: folder for those of the office.
nlohmann::json run_cell(const AblationCell& cell, const std::filesystem::path& drive,
                        const std::string& weights, const std::filesystem::path& pictures);

}  // namespace penumbra::apps
