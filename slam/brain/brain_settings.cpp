#include "slam/brain/brain_settings.h"

#include "nn/base/error.h"

namespace penumbra::slam::brain {

BrainSettings BrainSettings::ratslam() {
  BrainSettings settings;
  settings.templates = TemplateKind::intensity;
  settings.proof = PlaceProof::time;
  settings.sight = settings.calibration = false;
  settings.least_sharpness = 0.0;
  settings.keyframe_metres = 0.2;  // every frame of a robot that drives
  settings.least_similarity = 0.62;
  settings.agreeing_in_a_row = 4;
  settings.away = 150.0;
  settings.drift_metres = 1e9;  // it has no such guard
  settings.new_node_distance = 5.0;
  return settings;
}

void BrainSettings::check() const {
  const auto require = [](bool holds, const char* what, double found) {
    if (!holds) throw UsageError(fmt::format("brain settings: expected {}, found {:g}", what, found));
  };
  require(keyframe_share > 0.0, "keyframe_share above 0", keyframe_share);
  require(keyframe_turn > 0.0, "keyframe_turn above 0", keyframe_turn);
  require(keyframe_metres >= 0.0, "keyframe_metres of 0 or more", keyframe_metres);
  require(least_sharpness >= 0.0 && least_sharpness <= 1.0, "least_sharpness from 0 to 1", least_sharpness);
  require(least_similarity >= 0.0 && least_similarity <= 1.0, "least_similarity from 0 to 1",
          least_similarity);
  require(candidates >= 1, "at least one candidate", candidates);
  require(agreeing_in_a_row >= 1, "agreeing_in_a_row of 1 or more", agreeing_in_a_row);
  require(relaxation.rho > 0.0 && relaxation.rho <= 1.0, "rho above 0, at most 1", relaxation.rho);
  require(least_way_sigma > 0.0 && least_turn_sigma > 0.0, "standard deviations above 0",
          std::min(least_way_sigma, least_turn_sigma));
  if (templates == TemplateKind::intensity && proof == PlaceProof::time)
    require(keyframe_metres > 0.0, "keyframe_metres above 0 where no feature tells distances",
            keyframe_metres);
}

}  // namespace penumbra::slam::brain
