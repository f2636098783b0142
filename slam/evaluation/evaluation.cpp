#include "slam/evaluation/evaluation.h"

#include "slam/evaluation/ape.h"
#include "slam/evaluation/rpe.h"

namespace penumbra::slam {

Evaluation evaluate_trajectory(const Trajectory& reference, const Trajectory& estimate,
                               const EvaluationOptions& options) {
  Evaluation result;
  result.alignment = find_alignment(reference, estimate, options.alignment);
  result.aligned_estimate =
      options.alignment == Alignment::none ? estimate : transformed(estimate, result.alignment);
  const Trajectory& aligned = result.aligned_estimate;
  result.poses = static_cast<int>(reference.size());

  result.ape = error_statistics(absolute_pose_errors(reference, aligned));
  const RelativePoseErrors by_frames =
      relative_pose_errors(reference, aligned, pairs_by_frames(aligned, options.rpe_frames));
  result.rpe_frames = error_statistics(by_frames.translation);
  result.rpe_frames_rotation = error_statistics(by_frames.rotation);
  const RelativePoseErrors by_metres =
      relative_pose_errors(reference, aligned, pairs_by_metres(aligned, options.rpe_metres));
  result.rpe_metres = error_statistics(by_metres.translation);
  result.rpe_metres_rotation = error_statistics(by_metres.rotation);
  result.kitti = kitti_metrics(reference, aligned, options.segment_lengths);
  return result;
}

}  // namespace penumbra::slam
