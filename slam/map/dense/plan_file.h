// A map_server's YAML file, which says how to read the image of a plan: as Penumbra and nav2_map_saver write
// it, or drawn by hand. Lines "key: value" at any place; others are skipped.
//
//   image: plan.pgm                  beside the YAML file
//   resolution: 0.05                 metres a cell, 0.001 to 100
//   origin: [-1.5, 2.0, 0.0]         of the lower left corner: metres, and radians that the plan is turned by
//   negate: 0                        a pixel's occupancy is (255 - level) / 255, or level / 255 where not 0
//   occupied_thresh: 0.65            above it a cell is blocked
//   free_thresh: 0.196               below it a cell is free
#pragma once

#include <Eigen/Core>
#include <filesystem>

namespace penumbra::slam {

struct PlanFile {
  static constexpr double kLeastCell = 0.001, kMostCell = 100.0;  // metres
  static constexpr double kFarthestOrigin = 1e6;                  // metres, along either axis

  std::filesystem::path image;  // as the file names it
  double cell = 0.0;            // metres
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  bool negate = false;
  double occupied = 0.0, free = 0.0;  // occupancies
};

// Throws InputError (file, or file:line) for a file that cannot be read or lacks one of these lines, for what
// is no number or out of its bounds, and for a plan that is turned.
PlanFile read_plan_file(const std::filesystem::path& yaml);

}  // namespace penumbra::slam
