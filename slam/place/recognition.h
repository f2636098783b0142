// Finds where an image was taken without a prediction: in the whole map.
//
//   keyframes where the camera was last (the index learns of new ones late) -> verify each by geometry
//   none of them: the best places of the place index (place_index.h)        -> verify each by geometry
//     -> the one that most points agree with                                   (place_verifier.h)
//
// Where the camera was last a few points that agree are enough, since it was there a moment ago; anywhere
// else the proof must be as strong as a loop's by points alone: there a constellation may stand in for some
// of them because several keyframes must agree, here a single image is believed. What objects hide is not
// asked for here either. Cost: about 5 ms for every keyframe compared. Source: Mur-Artal, Tardos, ORB-SLAM
// (T-RO 2015), section V-C.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "slam/frontend/features/feature_view.h"
#include "slam/geometry/stereo_camera.h"
#include "slam/map/map.h"
#include "slam/place/place_index.h"
#include "slam/place/place_verifier.h"

namespace penumbra::slam {

struct RecognitionSettings {
  int last_keyframes = 5;
  int candidates = 5;  // places of the index
  // What a keyframe needs to be recognised: where the camera was last, and anywhere.
  PlaceVerifierSettings last{.fewest_ransac_inliers = 12,
                             .fewest_inliers = 20,
                             .least_share = 0.0,
                             .fewest_cells = 3,
                             .constellation = {.enabled = false}};
  PlaceVerifierSettings anywhere{.constellation = {.enabled = false}};
};

// The image's pose in the map, the keyframe that was recognised and the points that it shows; nothing where
// no keyframe is proven. `last`: keyframes where the camera was last, best first; `index` holds keyframes of
// `map`. The random draws depend on `seed` only. Needs the map's lock shared.
// `objects`: those that the image shows, in its camera's frame; may be empty.
std::optional<VerifiedPlace> recognise_image(const Map& map, const PlaceIndex& index,
                                             std::span<KeyFrame* const> last, const FeatureView& features,
                                             std::uint64_t seed, const RecognitionSettings& settings = {},
                                             const Constellation& objects = {});

}  // namespace penumbra::slam
