#include "slam/backend/local_bundle_adjustment.h"

#include <algorithm>

#include "slam/backend/bundle_adjustment.h"
#include "slam/backend/newcomers.h"
#include "slam/frontend/features/measurement.h"
#include "slam/map/keyframe_table.h"

namespace penumbra::slam {

namespace {

// The part of the map that is adjusted; keyframes and points in the order of the problem's poses and points.
struct Window {
  std::vector<KeyFrame*> keyframes;
  std::vector<MapPoint*> points;
  int free_keyframes = 0;
};

Window choose_window(KeyFrame* centre, const LocalBundleSettings& settings) {
  Window window;
  window.keyframes.push_back(centre);
  for (const Covisible& c : centre->covisibles) {
    if (static_cast<int>(window.keyframes.size()) >= settings.window) break;
    window.keyframes.push_back(c.keyframe);
  }
  window.free_keyframes = static_cast<int>(window.keyframes.size());

  for (const KeyFrame* keyframe : window.keyframes) {
    for (MapPoint* point : keyframe->points) {
      if (point != nullptr) window.points.push_back(point);
    }
  }
  const auto by_id = [](const MapPoint* a, const MapPoint* b) { return a->id < b->id; };
  std::sort(window.points.begin(), window.points.end(), by_id);
  window.points.erase(std::unique(window.points.begin(), window.points.end()), window.points.end());

  KeyframeTable border;
  for (const MapPoint* point : window.points) {
    for (const Observation& o : point->observations) ++border[o.keyframe];
  }
  for (KeyFrame* keyframe : window.keyframes) border[keyframe] = 0;
  border.sort_by_value();
  for (const KeyframeTable::Entry& c : border.entries()) {
    const int taken = static_cast<int>(window.keyframes.size()) - window.free_keyframes;
    if (c.value == 0 || taken >= settings.border) break;
    window.keyframes.push_back(c.keyframe);
  }
  return window;
}

BundleProblem make_problem(const Map& map, const Window& window) {
  BundleProblem problem;
  problem.camera = map.camera();
  KeyframeTable pose_of;
  // Without a border something else has to hold the window: its oldest keyframe.
  int oldest = 0;
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    KeyFrame* keyframe = window.keyframes[i];
    pose_of[keyframe] = static_cast<int>(i);
    problem.poses.push_back(keyframe->T_cw);
    problem.pose_fixed.push_back(static_cast<int>(i) >= window.free_keyframes || keyframe->id == 0);
    if (keyframe->id < window.keyframes[static_cast<std::size_t>(oldest)]->id) oldest = static_cast<int>(i);
  }
  if (std::count(problem.pose_fixed.begin(), problem.pose_fixed.end(), 1) == 0) {
    problem.pose_fixed[static_cast<std::size_t>(oldest)] = 1;
  }
  for (const MapPoint* point : window.points) {
    const int j = static_cast<int>(problem.points.size());
    problem.points.push_back(point->position);
    for (const Observation& o : point->observations) {
      const int* pose = pose_of.find(o.keyframe);
      if (pose == nullptr) continue;
      problem.observations.push_back({*pose, j, measurement_of(*o.keyframe, o.feature, map.scales()), true});
    }
  }
  return problem;
}

}  // namespace

LocalBundleReport adjust_local_bundle(KeyFrame* centre, Map& map, const LocalBundleSettings& settings,
                                      std::unique_lock<std::shared_mutex>* lock,
                                      const std::atomic<bool>* stop) {
  const Window window = choose_window(centre, settings);
  BundleProblem problem = make_problem(map, window);
  LocalBundleReport report;
  report.free_keyframes = window.free_keyframes;
  report.fixed_keyframes = static_cast<int>(window.keyframes.size()) - window.free_keyframes;
  report.points = static_cast<int>(window.points.size());
  report.observations = static_cast<int>(problem.observations.size());
  if (window.keyframes.size() < 2) return report;
  KeyFrame* newest = map.keyframes().back();

  if (lock != nullptr) lock->unlock();
  BundleSettings pass;
  pass.iterations = settings.robust_iterations;
  pass.threads = settings.threads;
  pass.stop = stop;
  solve_bundle(problem, pass);
  const auto stopped = [&] { return stop != nullptr && stop->load(std::memory_order_relaxed); };
  report.stopped = stopped();
  if (!report.stopped) {
    for (BundleObservation& o : problem.observations) o.active = within_gate(problem, o);
    pass.iterations = settings.iterations;
    pass.robust = false;
    solve_bundle(problem, pass);
    report.stopped = stopped();
  }

  if (lock != nullptr) lock->lock();
  PosesBefore before;
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    before[window.keyframes[i]] = window.keyframes[i]->T_cw;
    if (!problem.pose_fixed[i]) window.keyframes[i]->T_cw = problem.poses[i];
  }
  for (std::size_t j = 0; j < window.points.size(); ++j) window.points[j]->position = problem.points[j];
  move_newcomers(map, newest->id, before);
  for (const BundleObservation& o : problem.observations) {
    if (report.stopped || within_gate(problem, o)) continue;
    MapPoint* point = window.points[static_cast<std::size_t>(o.point)];
    map.remove_observation(point, window.keyframes[static_cast<std::size_t>(o.pose)]);
    map.update_point(point);
    ++report.removed_observations;
  }
  for (MapPoint* point : window.points) map.update_view(point);
  return report;
}

}  // namespace penumbra::slam
