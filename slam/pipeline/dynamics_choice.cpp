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
    // The depths of a box take more than the person, so what stands is given back: as the settings say, and
    // by the paper's letter where they do not, the better partner of its foreground (static-points.md).
    StaticPointMode& mode = settings.static_points.constraint.mode;
    if (masks != InstanceMasks::dbscan) {
      mode = StaticPointMode::off;
    } else if (mode == StaticPointMode::off) {
      mode = StaticPointMode::paper;
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
