#include "slam/evaluation/rpe.h"

#include <numbers>

#include "nn/base/error.h"
#include "slam/evaluation/alignment.h"

namespace penumbra::slam {

FramePairs pairs_by_frames(const Trajectory& trajectory, int frames) {
  if (frames < 1) throw UsageError(fmt::format("RPE step of {} frames: expected 1 or more", frames));
  FramePairs pairs;
  const int size = static_cast<int>(trajectory.size());
  for (int i = 0; frames < size - i; i += frames) pairs.emplace_back(i, i + frames);
  return pairs;
}

FramePairs pairs_by_metres(const Trajectory& trajectory, double metres) {
  if (!(metres > 0.0)) throw UsageError(fmt::format("RPE step of {:g} m: expected more than 0", metres));
  FramePairs pairs;
  int previous_cut = -1;
  double path = 0.0;  // since the last cut
  for (int i = 1; i < static_cast<int>(trajectory.size()); ++i) {
    const auto index = static_cast<std::size_t>(i);
    path += (trajectory[index].T_wc.translation - trajectory[index - 1].T_wc.translation).norm();
    if (path < metres) continue;
    if (previous_cut >= 0) pairs.emplace_back(previous_cut, i);
    previous_cut = i;
    path = 0.0;
  }
  return pairs;
}

RelativePoseErrors relative_pose_errors(const Trajectory& reference, const Trajectory& estimate,
                                        const FramePairs& pairs) {
  require_paired(reference, estimate, 0);
  const auto motion = [](const Trajectory& trajectory, int i, int j) {
    return trajectory[static_cast<std::size_t>(i)].T_wc.inverse() *
           trajectory[static_cast<std::size_t>(j)].T_wc;
  };
  RelativePoseErrors errors;
  for (const auto& [i, j] : pairs) {
    const SE3 error = motion(reference, i, j).inverse() * motion(estimate, i, j);
    errors.translation.push_back(error.translation.norm());
    errors.rotation.push_back(error.angle() * 180.0 / std::numbers::pi);
  }
  return errors;
}

}  // namespace penumbra::slam
