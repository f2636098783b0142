// Proves, or refutes, that an image shows the place of a keyframe, and finds the camera's pose there.
//
//   descriptors of the keyframe's points against the image's -> P3P in RANSAC -> pose
//     -> points of the keyframe and of its neighbours, looked for where the pose projects them -> pose
//     -> the same in a narrower window -> pose
//
// Proven means: enough of the neighbourhood's points agree with the pose, within their chi-square gates in
// both images, they are spread over the image, and they are a fair share of what should be seen. Points
// behind an object that is not proven to stand need not be seen: it may have come since. Similar looks
// without a common geometry (house fronts, trees) fail here. Where the objects that stand around the
// image are also those that stand around the keyframe (constellation.h), fewer points are enough, but never
// less than what determines the pose well. About 5 ms a keyframe.
// Source: Mur-Artal, Tardos, ORB-SLAM (T-RO 2015), sections V-C and VII-B.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "slam/geometry/stereo_camera.h"
#include "slam/map/map.h"
#include "slam/place/constellation.h"

namespace penumbra::slam {

struct PlaceVerifierSettings {
  int fewest_ransac_inliers = 12;
  int fewest_inliers = 40;   // points that agree with the final pose ...
  double least_share = 0.2;  // ... as a share of the points that it should show
  int fewest_cells = 8;      // of the image's 8 x 4 cells that hold one of them
  int neighbours = 10;       // covisible keyframes whose points are looked for, too
  ConstellationSettings constellation = {};
  // What is enough where the constellation supports the place.
  int fewest_supported_inliers = 20;
  double least_supported_share = 0.1;
  int fewest_supported_cells = 5;
};

struct VerifiedPlace {
  KeyFrame* keyframe = nullptr;   // of the map
  SE3 T_cw;                       // of the image, in the keyframe's world
  std::vector<MapPoint*> points;  // per feature of the image: the map point it shows, or nullptr
  int inliers = 0;                // how many do
  int visible = 0;                // points that the pose should show, hidden by nothing that is known
  int objects = 0;                // that agree, where the points alone had not been enough
};

// `objects`: those around the image, in its camera's frame; may be empty. The random draws depend on `seed`
// only.
std::optional<VerifiedPlace> verify_place(const Map& map, const FeatureView& features, KeyFrame* keyframe,
                                          std::uint64_t seed, const PlaceVerifierSettings& settings,
                                          const Constellation& objects = {});

// The points of a keyframe and of its closest covisible keyframes, each once, in the order of their ids.
std::vector<MapPoint*> points_around(const KeyFrame& keyframe, int neighbours);

}  // namespace penumbra::slam
