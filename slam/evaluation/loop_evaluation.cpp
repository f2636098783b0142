#include "slam/evaluation/loop_evaluation.h"

#include <algorithm>
#include <set>

#include "nn/base/error.h"

namespace penumbra::slam {

namespace {

double share(int part, int whole) { return whole == 0 ? 1.0 : static_cast<double>(part) / whole; }

const SE3& pose_of(const Trajectory& truth, int frame) {
  if (frame < 0 || frame >= static_cast<int>(truth.size())) {
    throw InputError("loop evaluation", fmt::format("frames below {}, as in the ground truth", truth.size()),
                     fmt::format("frame {}", frame));
  }
  return truth[static_cast<std::size_t>(frame)].T_wc;
}

bool is_revisit(const Trajectory& truth, const FramePair& pair, const RevisitSettings& settings) {
  return pair.frame - pair.earlier >= settings.fewest_frames_apart &&
         is_same_place(pose_of(truth, pair.frame), pose_of(truth, pair.earlier), settings);
}

// How many of the keyframes are revisits, and how many of those are among `found`.
struct RevisitCount {
  int revisits = 0, found = 0;
};
RevisitCount count_revisits(const Trajectory& truth, const std::vector<int>& revisits,
                            const std::vector<int>& keyframes, const std::set<int>& found) {
  RevisitCount count;
  for (const int frame : keyframes) {
    pose_of(truth, frame);  // throws where the truth lacks it
    if (revisits[static_cast<std::size_t>(frame)] < 0) continue;
    ++count.revisits;
    count.found += static_cast<int>(found.count(frame));
  }
  return count;
}

}  // namespace

bool is_same_place(const SE3& T_wa, const SE3& T_wb, const RevisitSettings& settings) {
  return (T_wa.translation - T_wb.translation).norm() <= settings.largest_distance &&
         (T_wa.inverse() * T_wb).angle() <= settings.largest_turn;
}

std::vector<int> find_revisits(const Trajectory& truth, const RevisitSettings& settings) {
  std::vector<double> way = {0.0};  // metres up to each frame
  for (std::size_t i = 1; i < truth.size(); ++i) {
    way.push_back(way.back() + (truth[i].T_wc.translation - truth[i - 1].T_wc.translation).norm());
  }
  std::vector<int> revisits(truth.size(), -1);
  for (int i = settings.fewest_frames_apart; i < static_cast<int>(truth.size()); ++i) {
    const TimedPose& here = truth[static_cast<std::size_t>(i)];
    double least = settings.largest_distance;
    for (int j = 0; j <= i - settings.fewest_frames_apart; ++j) {
      const TimedPose& there = truth[static_cast<std::size_t>(j)];
      const double distance = (here.T_wc.translation - there.T_wc.translation).norm();
      if (distance > least) continue;
      const double between = way[static_cast<std::size_t>(i)] - way[static_cast<std::size_t>(j)];
      if (between <= 2.0 * settings.largest_distance || !is_same_place(here.T_wc, there.T_wc, settings))
        continue;
      least = distance;
      revisits[static_cast<std::size_t>(i)] = j;
    }
  }
  return revisits;
}

std::vector<RevisitRegion> find_regions(const std::vector<int>& revisits, const RevisitSettings& settings) {
  std::vector<RevisitRegion> regions;
  for (int i = 0; i < static_cast<int>(revisits.size()); ++i) {
    const int earlier = revisits[static_cast<std::size_t>(i)];
    if (earlier < 0) continue;
    if (!regions.empty() && i - regions.back().end < settings.fewest_frames_apart) {
      regions.back().end = i + 1;
    } else {
      regions.push_back({i, i + 1, earlier, false});
    }
  }
  return regions;
}

int LoopEvaluation::correct_loops() const {
  return static_cast<int>(std::count_if(loops.begin(), loops.end(), [](const Loop& l) { return l.correct; }));
}
int LoopEvaluation::closed_regions() const {
  return static_cast<int>(
      std::count_if(regions.begin(), regions.end(), [](const RevisitRegion& r) { return r.closed; }));
}
double LoopEvaluation::precision() const { return share(correct_loops(), static_cast<int>(loops.size())); }
double LoopEvaluation::region_recall() const {
  return share(closed_regions(), static_cast<int>(regions.size()));
}
double LoopEvaluation::keyframe_recall() const { return share(tied_keyframes, revisited_keyframes); }

LoopEvaluation evaluate_loops(const Trajectory& truth, const std::vector<FramePair>& loops,
                              const std::vector<int>& keyframes, const std::vector<FramePair>& covisible,
                              const RevisitSettings& settings) {
  LoopEvaluation result;
  const std::vector<int> revisits = find_revisits(truth, settings);
  result.regions = find_regions(revisits, settings);
  for (const FramePair& pair : loops) {
    const SE3 &here = pose_of(truth, pair.frame), &there = pose_of(truth, pair.earlier);
    LoopEvaluation::Loop loop;
    loop.frames = pair;
    loop.distance = (here.translation - there.translation).norm();
    loop.turn = (here.inverse() * there).angle();
    loop.correct = is_revisit(truth, pair, settings);
    if (loop.correct) {
      for (RevisitRegion& region : result.regions) {
        region.closed = region.closed || (pair.frame >= region.begin && pair.frame < region.end);
      }
    }
    result.loops.push_back(loop);
  }
  std::set<int> tied;
  for (const FramePair& pair : covisible) {
    if (pair.frame - pair.earlier >= settings.fewest_frames_apart) tied.insert(pair.frame);
  }
  const RevisitCount count = count_revisits(truth, revisits, keyframes, tied);
  result.revisited_keyframes = count.revisits;
  result.tied_keyframes = count.found;
  return result;
}

double RecognitionEvaluation::precision() const { return share(right_places, places); }
double RecognitionEvaluation::recall() const { return share(recognised_keyframes, revisited_keyframes); }

RecognitionEvaluation evaluate_recognition(const Trajectory& truth, const std::vector<FramePair>& recognised,
                                           const std::vector<int>& keyframes,
                                           const RevisitSettings& settings) {
  RecognitionEvaluation result;
  std::set<int> right;
  for (const FramePair& pair : recognised) {
    ++result.places;
    if (!is_revisit(truth, pair, settings)) continue;
    ++result.right_places;
    right.insert(pair.frame);
  }
  const RevisitCount count = count_revisits(truth, find_revisits(truth, settings), keyframes, right);
  result.revisited_keyframes = count.revisits;
  result.recognised_keyframes = count.found;
  return result;
}

}  // namespace penumbra::slam
