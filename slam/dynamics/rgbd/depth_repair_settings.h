// Settings of the repair of depth maps (depth_repair.h, which tells what the modes do).
#pragma once

namespace penumbra::slam {

enum class RepairMode { off, paper, border, median, modes };

struct DepthRepairSettings {
  RepairMode mode = RepairMode::modes;
  int grey_difference = 5;  // theta2, grey values; 1 to 5
  double nearer_votes = 0.5;
  double two_surfaces = 0.1;  // of the nearer depth
  int farthest = 20;          // pixels from a measured depth, by cells: a hole beyond stays one
};

// Metres: nothing is measured so far away, and no sum of depths runs over. No number is no depth either.
constexpr float kMostRepairMetres = 500.0F;
inline bool can_be_used(float metres) { return metres > 0.0F && metres < kMostRepairMetres; }

}  // namespace penumbra::slam
