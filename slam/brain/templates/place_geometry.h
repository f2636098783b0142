// Proves that an image shows the place of a template, and finds where the camera is against it.
//
//   a few hundred features with their depth are kept of the template
//   -> descriptors each other's nearest -> P3P in RANSAC -> pose of the camera in the template's frame
//
// Proven means: enough pairs agree with one rigid motion, they are a fair share of what matched, they are
// spread over the image, and the motion is one that a robot on the ground can make. This is what is left of
// slam/place/place_verifier.h where no map of points stands around the place: about 1 ms in place of 5, and
// 7 kB a template.
#pragma once

#include <optional>
#include <vector>

#include "slam/brain/motion/camera_mount.h"
#include "slam/brain/motion/plane.h"
#include "slam/frontend/features/frame_features.h"
#include "slam/geometry/pnp_ransac.h"

namespace penumbra::slam::brain {

// A feature with its place in the camera's frame, metres.
struct PlacePoint {
  slam::Descriptor descriptor;
  std::array<float, 3> position;
  float unused = 0.0F;  // files have no uninitialised bytes
};

struct PlaceGeometrySettings {
  int features = 500;         // an image
  double farthest = 80.0;     // of points that are kept, in baselines; RGB-D's baseline is nominal
  int most_points = 220;      // kept of a template, the nearest ones
  int fewest_inliers = 15;    // pairs that agree with the motion ...
  double least_share = 0.35;  // ... as a share of the pairs that look alike
  int fewest_columns = 4;     // of the image's 8 that hold one of them
  double most_climb = 0.15;   // the motion's height as a share of its length, beside 0.3 m
  double most_tilt = 0.12;    // radians, about the other two axes
};

// What is kept of a frame's features.
std::vector<PlacePoint> place_points(const StereoCamera& camera, const FrameFeatures& features,
                                     const PlaceGeometrySettings& settings);
// Their median distance from the camera, metres; 0 without points.
double median_distance(const std::vector<PlacePoint>& points);

struct ProvenPlace {
  PlanePose motion;  // of the robot now, in the template's frame
  int inliers = 0;
  double share = 0.0;  // of the pairs
};

// `scales`: of the pyramid's levels. The random draws depend on `seed` only.
std::optional<ProvenPlace> prove_place(const StereoCamera& camera, const std::vector<PlacePoint>& place,
                                       const FrameFeatures& now, const std::vector<double>& scales,
                                       std::uint64_t seed, const PlaceGeometrySettings& settings,
                                       const CameraMount& mount = {});

}  // namespace penumbra::slam::brain
