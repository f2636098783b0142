// All that can be chosen about the brain-inspired SLAM.
#pragma once

#include "slam/brain/landmarks/similarity.h"
#include "slam/brain/map/relaxation.h"
#include "slam/brain/templates/place_geometry.h"
#include "slam/brain/templates/template_memory.h"

namespace penumbra::slam::brain {

// What proves that a familiar view shows the same place.
enum class PlaceProof {
  geometry,  // one rigid motion explains both (templates/place_geometry.h), in two keyframes in a row
  time       // nothing but several views in a row that are familiar from places in a row, as RatSLAM
};

struct BrainSettings {
  TemplateKind templates = TemplateKind::landmarks;
  PlaceProof proof = PlaceProof::geometry;
  bool recall = true;  // false: no place is known again; what is left is the odometry
  SimilaritySettings similarity;
  ProfileSettings profile;
  PlaceGeometrySettings geometry;
  CameraMount mount;  // how the camera is turned on the robot
  RelaxationSettings relaxation;

  // Keyframes (11, 12): so far from the last one, as a share of the scene's median distance, or so turned.
  double keyframe_share = 0.2;
  double keyframe_turn = 0.2;     // radians
  double keyframe_metres = 0.0;   // above 0: in place of the share; the intensity templates take it always
  double least_sharpness = 0.75;  // share of the last keyframes' mean Tenengrad; 0: no test

  // Steps by sight: the keyframe before is tried by geometry first. Its motion is the link's (sight), and
  // teaches how far off the felt speed and turns are (calibration).
  bool sight = true, calibration = true;
  double calibration_metres = 100.0, calibration_seconds = 30.0;  // what is remembered of it

  // A view is familiar from this similarity on.
  double least_similarity = 0.35;
  int candidates = 3;         // places that are tried by geometry
  double farthest = 1.5;      // keyframe distances from a place that still are that place
  int agreeing_in_a_row = 2;  // keyframes that must find places near each other
  double away = 20.0;         // keyframe distances that the robot must have driven since a place
  double drift_share = 0.15;  // of the way since the last fix: how far off the robot may believe to be ...
  double seen_drift_share = 0.03;  // ... of what of it was seen ...
  double drift_metres = 3.0;       // ... beside so many keyframe distances
  double most_rival_share = 0.6;   // inliers that another place may have, as a share of the best one's
  double phi = 0.8;                // of the tie between template and place (10)
  double new_node_distance = 0.7;  // G_th, in keyframe distances (19)

  // What links are worth: standard deviations.
  double way_sigma = 0.04;   // metres per metre of way ...
  double turn_sigma = 0.01;  // ... and radians per radian, beside
  double least_way_sigma = 0.02, least_turn_sigma = 0.002;
  double proven_sigma = 0.05, proven_turn_sigma = 0.004;    // of a place proven by geometry
  double familiar_sigma = 1.0, familiar_turn_sigma = 0.05;  // of one that only looks alike

  int threads = 1;
  std::uint64_t seed = 1;

  // From which similarity on intensity profiles are familiar where geometry proves them.
  static constexpr double least_profile_similarity = 0.42;

  // RatSLAM as it was published, on this position model and map: intensity profiles, proven by time.
  static BrainSettings ratslam();
  // Throws UsageError naming the setting that makes no sense.
  void check() const;
};

}  // namespace penumbra::slam::brain
