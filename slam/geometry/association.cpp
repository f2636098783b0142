#include "slam/geometry/association.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "nn/base/error.h"

namespace penumbra::slam {

namespace {

std::size_t nearest_in_time(std::span<const double> times, double time) {
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  if (after == times.begin()) return 0;
  const auto before = std::prev(after);
  const bool take_before = after == times.end() || time - *before <= *after - time;
  return static_cast<std::size_t>((take_before ? before : after) - times.begin());
}

std::vector<double> times_of(const Trajectory& trajectory) {
  std::vector<double> times;
  times.reserve(trajectory.size());
  for (const TimedPose& pose : trajectory) times.push_back(pose.timestamp);
  return times;
}

std::string span_of(const Trajectory& t) {
  return t.empty() ? std::string("no pose")
                   : fmt::format("{:.3f}..{:.3f} s", t.front().timestamp, t.back().timestamp);
}

// What to add to the estimate's times so that they are those of the nearest true poses: the median distance,
// with both signs where the nearest before and after are about as far.
std::string offset_to_nearest(const Trajectory& reference, const Trajectory& estimate) {
  constexpr double kAboutAsFar = 1.1;
  const std::vector<double> times = times_of(reference);
  std::vector<double> distances;
  std::size_t earlier = 0, later = 0;
  for (const TimedPose& pose : estimate) {
    const double time = pose.timestamp;
    const double distance = std::abs(times[nearest_in_time(times, time)] - time);
    const auto after = std::lower_bound(times.begin(), times.end(), time);
    if (after != times.end() && *after - time <= kAboutAsFar * distance) ++later;
    if (after != times.begin() && time - *std::prev(after) <= kAboutAsFar * distance) ++earlier;
    distances.push_back(distance);
  }
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>((distances.size() - 1) / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  if (10 * std::min(earlier, later) > distances.size())
    return fmt::format("{:.6f} or {:.6f}", -*middle, *middle);
  return fmt::format("{:.6f}", later > earlier ? *middle : -*middle);
}

// Why no times are the same.
std::string hint(const Trajectory& reference, const Trajectory& estimate, double max_difference) {
  if (reference.empty() || estimate.empty()) return {};
  constexpr double kClockFromZero = 1e8;  // seconds; clocks that count from 1970 are beyond
  const double offset = reference.front().timestamp - estimate.front().timestamp;
  const bool one_from_zero = (std::abs(reference.front().timestamp) < kClockFromZero) !=
                             (std::abs(estimate.front().timestamp) < kClockFromZero);
  if (one_from_zero) {
    return fmt::format(
        ": one clock begins at 0 and one in 1970 (if both begin together: --time-offset {:.6f})", offset);
  }
  const bool apart = reference.front().timestamp > estimate.back().timestamp ||
                     estimate.front().timestamp > reference.back().timestamp;
  if (apart) return fmt::format(": the clocks differ (if both begin together: --time-offset {:.6f})", offset);
  return fmt::format(
      ": the times lie between each other, usually as far as --time-offset {} would make up for "
      "(--max-time-difference is {:g} s)",
      offset_to_nearest(reference, estimate), max_difference);
}

}  // namespace

std::vector<TimePair> associate_times(std::span<const double> first, std::span<const double> second,
                                      double max_difference) {
  const bool first_is_longer = first.size() >= second.size();
  const std::span<const double> longer = first_is_longer ? first : second;
  const std::span<const double> shorter = first_is_longer ? second : first;
  std::vector<TimePair> pairs;
  double last_difference = 0.0;
  std::size_t last_in_long = 0;
  for (std::size_t i = 0; i < shorter.size() && !longer.empty(); ++i) {
    const std::size_t nearest = nearest_in_time(longer, shorter[i]);
    const double difference = std::abs(longer[nearest] - shorter[i]);
    if (!(difference <= max_difference)) continue;
    const TimePair pair = first_is_longer ? TimePair{nearest, i} : TimePair{i, nearest};
    // Both are ordered by time, so whoever wants the same partner stands next to us.
    if (!pairs.empty() && last_in_long == nearest) {
      if (difference >= last_difference) continue;
      pairs.back() = pair;
    } else {
      pairs.push_back(pair);
    }
    last_difference = difference;
    last_in_long = nearest;
  }
  return pairs;
}

TrajectoryPair associate_by_time(const Trajectory& reference, const Trajectory& estimate,
                                 double max_difference) {
  const std::vector<TimePair> matches =
      associate_times(times_of(reference), times_of(estimate), max_difference);
  if (matches.empty()) {
    throw InputError("ground truth and estimate", fmt::format("times within {:g} s", max_difference),
                     fmt::format("{} against {}{}", span_of(reference), span_of(estimate),
                                 hint(reference, estimate, max_difference)));
  }
  TrajectoryPair pair;
  for (const auto& [in_reference, in_estimate] : matches) {
    pair.reference.push_back(reference[in_reference]);
    pair.estimate.push_back(estimate[in_estimate]);
  }
  return pair;
}

}  // namespace penumbra::slam
