#include "slam/mapping/full_bundle_adjustment.h"

#include <algorithm>
#include <unordered_map>

#include "slam/features/measurement.h"

namespace penumbra::slam {

FullBundleAdjustment::FullBundleAdjustment(const StereoCamera& camera, const Map& map, int submap,
                                           const FullBundleSettings& settings)
    : submap_(submap), settings_(settings) {
  problem_.camera = camera;
  std::unordered_map<const KeyFrame*, int> pose_of;
  for (KeyFrame* keyframe : map.keyframes()) {
    if (keyframe->submap != submap) continue;
    pose_of[keyframe] = static_cast<int>(keyframes_.size());
    problem_.poses.push_back(keyframe->T_cw);
    problem_.pose_fixed.push_back(keyframes_.empty());
    keyframes_.push_back(keyframe);
  }
  for (const auto& point : map.points()) {
    if (point->erased || point->observations.size() < 2) continue;
    if (point->observations.front().keyframe->submap != submap) continue;
    const int j = static_cast<int>(points_.size());
    points_.push_back(point.get());
    problem_.points.push_back(point->position);
    for (const Observation& o : point->observations) {
      const auto pose = pose_of.find(o.keyframe);
      if (pose == pose_of.end()) continue;
      problem_.observations.push_back(
          {pose->second, j, measurement_of(*o.keyframe, o.feature, map.scales()), true});
    }
  }
  report_.keyframes = static_cast<int>(keyframes_.size());
  report_.points = static_cast<int>(points_.size());
  report_.observations = static_cast<int>(problem_.observations.size());
}

bool FullBundleAdjustment::within_gate(const BundleObservation& o) const {
  const Eigen::Vector3d p =
      problem_.poses[static_cast<std::size_t>(o.pose)] * problem_.points[static_cast<std::size_t>(o.point)];
  if (p.z() <= 0.0) return false;
  const Eigen::Vector3d e = reprojection_error(problem_.camera, p, o.measurement);
  return e.squaredNorm() * o.measurement.inverse_variance <= o.measurement.gate();
}

void FullBundleAdjustment::solve(const std::atomic<bool>* stop) {
  BundleSettings pass;
  pass.iterations = settings_.robust_iterations;
  pass.stop = stop;
  report_.robust = solve_bundle(problem_, pass);
  report_.stopped = stop != nullptr && stop->load();
  if (report_.stopped) return;
  for (BundleObservation& o : problem_.observations) o.active = within_gate(o);
  pass.iterations = settings_.iterations;
  pass.robust = false;
  report_.final = solve_bundle(problem_, pass);
  report_.stopped = stop != nullptr && stop->load();
}

void FullBundleAdjustment::apply(Map& map) {
  // Where every keyframe was, for what is not in the problem and moves along.
  std::unordered_map<const KeyFrame*, SE3> before;
  for (const KeyFrame* keyframe : map.keyframes()) before[keyframe] = keyframe->T_cw;
  std::unordered_map<const MapPoint*, bool> adjusted;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    if (!keyframes_[i]->erased) keyframes_[i]->T_cw = problem_.poses[i];
  }
  const int newest = keyframes_.empty() ? -1 : keyframes_.back()->id;
  for (KeyFrame* keyframe : map.keyframes()) {
    if (keyframe->submap != submap_ || keyframe->id <= newest) continue;
    // Added since: keeps its place relative to its closest older neighbour.
    const KeyFrame* stand = keyframes_.back();
    for (const Covisible& c : keyframe->covisibles) {
      if (c.keyframe->id < keyframe->id && c.keyframe->submap == submap_) {
        stand = c.keyframe;
        break;
      }
    }
    if (!stand->erased) keyframe->T_cw = keyframe->T_cw * before[stand].inverse() * stand->T_cw;
  }
  for (std::size_t j = 0; j < points_.size(); ++j) {
    if (points_[j]->erased) continue;
    points_[j]->position = problem_.points[j];
    adjusted[points_[j]] = true;
  }
  for (const auto& point : map.points()) {
    if (point->erased || point->observations.empty() || adjusted.count(point.get()) > 0) continue;
    const KeyFrame* keyframe = point->observations.front().keyframe;
    if (keyframe->submap != submap_) continue;
    point->position = keyframe->T_cw.inverse() * (before[keyframe] * point->position);
  }
  for (const BundleObservation& o : problem_.observations) {
    if (report_.stopped || within_gate(o)) continue;
    MapPoint* point = points_[static_cast<std::size_t>(o.point)];
    if (point->erased) continue;
    map.remove_observation(point, keyframes_[static_cast<std::size_t>(o.pose)]);
    ++report_.removed_observations;
  }
  for (const auto& point : map.points()) {
    if (!point->erased) map.update_point(point.get());
  }
}

}  // namespace penumbra::slam
