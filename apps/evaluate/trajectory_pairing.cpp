#include "apps/evaluate/trajectory_pairing.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "apps/common/log.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "slam/sources/frame_range.h"

namespace penumbra::apps {

namespace {

using slam::TrajectoryFormat;

constexpr std::size_t kFewestPairs = 3;  // that determine an alignment
constexpr std::size_t kFewPairs = 10;    // figures from fewer say little

struct Formats {
  TrajectoryFormat truth, estimate;
};

Formats find_formats(const PairingOptions& options) {
  for (const TrajectoryFormat format : {TrajectoryFormat::kitti, TrajectoryFormat::tum,
                                        TrajectoryFormat::euroc, TrajectoryFormat::tartanair}) {
    if (options.format == to_string(format)) return {format, format};
  }
  const Formats formats{slam::detect_trajectory_format(options.ground_truth),
                        slam::detect_trajectory_format(options.estimate)};
  // TartanAir's ground truth has no times where estimates do; its lines are the frames.
  const bool fits =
      has_times(formats.truth) == has_times(formats.estimate) || formats.truth == TrajectoryFormat::tartanair;
  if (!fits) {
    throw UsageError(
        fmt::format("the ground truth is in {} format and the estimate in {}: give both with times or "
                    "both without",
                    to_string(formats.truth), to_string(formats.estimate)));
  }
  return formats;
}

slam::Trajectory read_with_notes(const std::string& path, TrajectoryFormat format) {
  slam::Notes notes;
  slam::Trajectory trajectory = slam::read_trajectory(path, format, &notes);
  for (const std::string& note : notes) log_warning("{}", note);
  return trajectory;
}

// Whether the "times" are other than 0, 1, 2, ...: frame numbers.
bool has_frame_numbers(const slam::Trajectory& trajectory) {
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    if (trajectory[i].timestamp != static_cast<double>(i)) return true;
  }
  return false;
}

slam::TrajectoryPair pair_by_line(const PairingOptions& options, slam::Trajectory truth,
                                  const slam::Trajectory& estimate, bool estimate_has_times) {
  const bool by_number = has_frame_numbers(truth) || (!estimate_has_times && has_frame_numbers(estimate));
  if (!options.frames.empty()) {
    const slam::FrameRange range = slam::parse_frame_range(options.frames);
    const int size = range.size(static_cast<int>(truth.size()), options.ground_truth);
    const auto first = truth.begin() + range.begin;
    truth = slam::Trajectory(first, first + size);
  }
  if (by_number && options.frames.empty()) {
    log_warning("the poses are paired by the numbers of their frames");
    return slam::associate_by_time(truth, estimate, 0.0);
  }
  if (truth.size() != estimate.size()) {
    throw InputError(options.estimate,
                     fmt::format("{} as in {}{}", counted(truth.size(), "pose"), options.ground_truth,
                                 options.frames.empty() ? "" : " " + options.frames),
                     fmt::format("{} (--frames A:B picks a part of the ground truth)", estimate.size()));
  }
  if (estimate_has_times)
    log_warning("the ground truth has no times: line i belongs to pose i of the estimate");
  return {truth, estimate};
}

}  // namespace

PairedTrajectories pair_trajectories(const PairingOptions& options) {
  const Formats formats = find_formats(options);
  const bool by_time = has_times(formats.truth);
  if (by_time && !options.frames.empty()) {
    throw UsageError("--frames is for KITTI files: TUM trajectories are paired by their times");
  }
  if (!by_time && options.time_offset != 0.0) {
    throw UsageError("--time-offset is for files with times: the ground truth has none");
  }
  const slam::Trajectory truth = read_with_notes(options.ground_truth, formats.truth);
  slam::Trajectory estimate = read_with_notes(options.estimate, formats.estimate);
  if (!by_time) {
    slam::TrajectoryPair pair = pair_by_line(options, truth, estimate, has_times(formats.estimate));
    const std::size_t in_truth = options.frames.empty() ? truth.size() : pair.reference.size();
    return {std::move(pair), formats.truth, in_truth, estimate.size()};
  }
  for (slam::TimedPose& pose : estimate) pose.timestamp += options.time_offset;
  slam::TrajectoryPair pair = slam::associate_by_time(truth, estimate, options.max_time_difference);
  log_info("with a ground truth within {:g} s: {} of {}", options.max_time_difference, pair.estimate.size(),
           counted(estimate.size(), "estimated pose"));
  return {std::move(pair), formats.truth, truth.size(), estimate.size()};
}

void check_pair_count(const PairedTrajectories& paired, slam::Alignment alignment) {
  const std::size_t pairs = paired.pair.reference.size();
  const std::string counts =
      fmt::format("{} of {} estimated and {} true poses", pairs, paired.in_estimate, paired.in_truth);
  if (alignment != slam::Alignment::none && pairs < kFewestPairs) {
    throw InputError("ground truth and estimate",
                     fmt::format("at least {} pairs of poses to fit the alignment {} to (or --align none)",
                                 kFewestPairs, to_string(alignment)),
                     fmt::format("{}: {}", pairs, counts));
  }
  if (2 * pairs < std::min(paired.in_estimate, paired.in_truth)) {
    log_warning("only {} belong together: do the clocks agree (--time-offset, --max-time-difference)?",
                counts);
  } else if (pairs < kFewPairs && pairs < std::max(paired.in_estimate, paired.in_truth)) {
    log_warning("only {} belong together: figures from so few say little", counts);
  }
}

}  // namespace penumbra::apps
