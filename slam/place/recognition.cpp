#include "slam/place/recognition.h"

#include <algorithm>
#include <vector>

namespace penumbra::slam {

std::optional<VerifiedPlace> recognise_image(const Map& map, const PlaceIndex& index,
                                             std::span<KeyFrame* const> last, const FeatureView& features,
                                             std::uint64_t seed, const RecognitionSettings& settings,
                                             const Constellation& objects) {
  std::optional<VerifiedPlace> best;
  const auto compare = [&](KeyFrame* keyframe, const PlaceVerifierSettings& needed) {
    std::optional<VerifiedPlace> place = verify_place(map, features, keyframe, seed, needed, objects);
    if (place && (!best || place->inliers > best->inliers)) best = std::move(place);
  };
  const std::size_t near = static_cast<std::size_t>(std::max(settings.last_keyframes, 0));
  for (KeyFrame* keyframe : last.first(std::min(near, last.size()))) compare(keyframe, settings.last);
  if (best) return best;
  for (const PlaceCandidate& candidate : index.query(features, settings.candidates)) {
    compare(candidate.keyframe, settings.anywhere);
  }
  return best;
}

}  // namespace penumbra::slam
