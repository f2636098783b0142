#include "slam/tracking/recognition.h"

#include <algorithm>
#include <vector>

namespace penumbra::slam {

std::optional<VerifiedPlace> recognise_image(const StereoCamera& camera, const Map& map,
                                             const PlaceIndex& index, const FrameFeatures& features,
                                             std::uint64_t seed, const RecognitionSettings& settings) {
  std::optional<VerifiedPlace> best;
  const auto compare = [&](KeyFrame* keyframe, const PlaceVerifierSettings& needed) {
    std::optional<VerifiedPlace> place = verify_place(camera, map, features, keyframe, seed, needed);
    if (place && (!best || place->inliers > best->inliers)) best = std::move(place);
  };
  const std::vector<KeyFrame*>& keyframes = map.keyframes();
  const int newest = std::min(settings.newest_keyframes, static_cast<int>(keyframes.size()));
  for (int n = 0; n < newest; ++n) compare(*(keyframes.end() - 1 - n), settings.newest);
  if (best) return best;
  for (const PlaceCandidate& candidate : index.query(features, settings.candidates)) {
    compare(candidate.keyframe, settings.anywhere);
  }
  return best;
}

}  // namespace penumbra::slam
