#include "slam/pipeline/dynamics_choice.h"

#include <utility>

namespace penumbra::slam {

bool choose_dynamics(std::string_view name, SemanticsSettings& settings) {
  constexpr std::pair<std::string_view, InstanceMasks> kNames[] = {
      {"masks", InstanceMasks::detector},
      {"boxes", InstanceMasks::boxes},
      {"depth-clusters", InstanceMasks::depth_clusters},
      {"static-points", InstanceMasks::dbscan}};
  for (const auto& [known, masks] : kNames) {
    if (name != known) continue;
    settings.depth_masks.masks = masks;
    settings.static_points.constraint.mode = StaticPointMode::off;
    if (masks == InstanceMasks::dbscan) {  // both in the paper's letter, which was measured best together
      settings.depth_masks.foreground.mode = ForegroundMode::paper;
      settings.static_points.constraint.mode = StaticPointMode::paper;
    }
    return true;
  }
  return false;
}

bool class_decides(const SemanticsSettings& settings) {
  return settings.depth_masks.masks != InstanceMasks::detector ||
         settings.static_points.constraint.mode != StaticPointMode::off;
}

bool needs_depth(InstanceMasks masks) {
  return masks == InstanceMasks::depth_clusters || masks == InstanceMasks::dbscan;
}

}  // namespace penumbra::slam
