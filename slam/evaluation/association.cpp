#include "slam/evaluation/association.h"

#include <algorithm>
#include <cmath>

#include "nn/base/error.h"

namespace penumbra::slam {

namespace {

struct Match {
  std::size_t in_short = 0, in_long = 0;
  double difference = 0.0;  // seconds
};

std::size_t nearest_in_time(const Trajectory& trajectory, double time) {
  const auto after =
      std::lower_bound(trajectory.begin(), trajectory.end(), time,
                       [](const TimedPose& pose, double value) { return pose.timestamp < value; });
  if (after == trajectory.begin()) return 0;
  const auto before = std::prev(after);
  const bool take_before = after == trajectory.end() || time - before->timestamp <= after->timestamp - time;
  return static_cast<std::size_t>((take_before ? before : after) - trajectory.begin());
}

}  // namespace

TrajectoryPair associate_by_time(const Trajectory& reference, const Trajectory& estimate,
                                 double max_difference) {
  const bool reference_is_longer = reference.size() >= estimate.size();
  const Trajectory& longer = reference_is_longer ? reference : estimate;
  const Trajectory& shorter = reference_is_longer ? estimate : reference;

  std::vector<Match> matches;
  for (std::size_t i = 0; i < shorter.size() && !longer.empty(); ++i) {
    const std::size_t nearest = nearest_in_time(longer, shorter[i].timestamp);
    const Match match{i, nearest, std::abs(longer[nearest].timestamp - shorter[i].timestamp)};
    if (!(match.difference <= max_difference)) continue;
    // Both are ordered by time, so whoever wants the same partner stands next to us.
    if (!matches.empty() && matches.back().in_long == match.in_long) {
      if (match.difference < matches.back().difference) matches.back() = match;
    } else {
      matches.push_back(match);
    }
  }
  if (matches.empty()) {
    const auto span = [](const Trajectory& t) {
      return t.empty() ? std::string("no pose")
                       : fmt::format("{:.3f}..{:.3f} s", t.front().timestamp, t.back().timestamp);
    };
    throw InputError("ground truth and estimate", fmt::format("times within {:g} s", max_difference),
                     fmt::format("{} against {}", span(reference), span(estimate)));
  }
  TrajectoryPair pair;
  for (const Match& match : matches) {
    const TimedPose &in_short = shorter[match.in_short], &in_long = longer[match.in_long];
    pair.reference.push_back(reference_is_longer ? in_long : in_short);
    pair.estimate.push_back(reference_is_longer ? in_short : in_long);
  }
  return pair;
}

}  // namespace penumbra::slam
