#include "slam/backend/full_bundle_adjustment.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "slam/backend/newcomers.h"
#include "slam/frontend/features/measurement.h"

namespace penumbra::slam {

namespace {

constexpr double kLeastDisparityOffset = 0.05;  // pixels; a smaller one is taken for none

}  // namespace

FullBundleAdjustment::FullBundleAdjustment(const Map& map, int submap, const FullBundleSettings& settings)
    : settings_(settings) {
  problem_.camera = map.camera();
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
  const bool is_most_of_map = 2 * keyframes_.size() > map.keyframes().size();
  if (!is_most_of_map) settings_.disparity_offset_sigma = 0.0;
  report_.keyframes = static_cast<int>(keyframes_.size());
  report_.points = static_cast<int>(points_.size());
  report_.observations = static_cast<int>(problem_.observations.size());
}

void FullBundleAdjustment::solve(const std::atomic<bool>* stop) {
  BundleSettings pass;
  pass.iterations = settings_.robust_iterations;
  pass.threads = settings_.threads;
  pass.stop = stop;
  report_.robust = solve_bundle(problem_, pass);
  report_.stopped = stop != nullptr && stop->load();
  if (report_.stopped) return;
  for (BundleObservation& o : problem_.observations) o.active = within_gate(problem_, o);
  pass.iterations = settings_.iterations;
  pass.robust = false;
  problem_.disparity_offset_sigma = settings_.disparity_offset_sigma;
  report_.final = solve_bundle(problem_, pass);
  const double offset = problem_.camera.disparity_offset;
  if (problem_.disparity_offset_sigma > 0.0 && std::abs(offset) < kLeastDisparityOffset) {
    problem_.camera.disparity_offset = problem_.disparity_offset_sigma = 0.0;
    report_.final = solve_bundle(problem_, pass);
    // Stopped before it began: the map still fits the offset.
    if (report_.final.iterations == 0) problem_.camera.disparity_offset = offset;
  }
  report_.stopped = stop != nullptr && stop->load();
}

void FullBundleAdjustment::apply(Map& map) {
  map.set_disparity_offset(problem_.camera.disparity_offset);
  PosesBefore before;
  std::unordered_set<const MapPoint*> adjusted;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    if (keyframes_[i]->erased) continue;
    before[keyframes_[i]] = keyframes_[i]->T_cw;
    keyframes_[i]->T_cw = problem_.poses[i];
  }
  for (std::size_t j = 0; j < points_.size(); ++j) {
    if (points_[j]->erased) continue;
    points_[j]->position = problem_.points[j];
    adjusted.insert(points_[j]);
  }
  // What is not in the problem moves along with a keyframe that sees it.
  for (const auto& point : map.points()) {
    if (point->erased || point->observations.empty() || adjusted.count(point.get()) > 0) continue;
    const auto seen_by = before.find(point->observations.front().keyframe);
    if (seen_by == before.end()) continue;
    point->position = seen_by->first->T_cw.inverse() * (seen_by->second * point->position);
  }
  move_newcomers(map, keyframes_.empty() ? -1 : keyframes_.back()->id, before);
  for (const BundleObservation& o : problem_.observations) {
    if (report_.stopped || within_gate(problem_, o)) continue;
    MapPoint* point = points_[static_cast<std::size_t>(o.point)];
    if (point->erased) continue;
    map.remove_observation(point, keyframes_[static_cast<std::size_t>(o.pose)]);
    map.update_point(point);
    ++report_.removed_observations;
  }
  for (const auto& point : map.points()) {
    map.update_view(point.get());
  }
}

}  // namespace penumbra::slam
