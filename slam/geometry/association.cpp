#include "slam/geometry/association.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>
#include <string>
#include <tuple>

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

struct ListedTime {
  double time = 0.0;
  bool in_first = false;
  std::size_t place = 0;  // in its list
};

// Two of them side by side, and how far apart.
using Neighbours = std::tuple<double, std::size_t, std::size_t>;

// Both lists in the order of time; of equal times in one list the first counts.
std::vector<ListedTime> merged(std::span<const double> first, std::span<const double> second) {
  std::vector<ListedTime> all;
  all.reserve(first.size() + second.size());
  const auto repeats = [](std::span<const double> times, std::size_t i) {
    return i > 0 && times[i] == times[i - 1];
  };
  for (std::size_t i = 0, j = 0; i < first.size() || j < second.size();) {
    const bool from_first = j == second.size() || (i < first.size() && first[i] <= second[j]);
    if (from_first && !repeats(first, i)) all.push_back({first[i], true, i});
    if (!from_first && !repeats(second, j)) all.push_back({second[j], false, j});
    ++(from_first ? i : j);
  }
  return all;
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
  const std::vector<ListedTime> all = merged(first, second);
  // The nearest pair of those that are left always stands side by side there, so that only neighbours are
  // candidates; where a pair is taken, those on both sides of it become neighbours.
  std::vector<std::size_t> before(all.size() + 1), after(all.size() + 1);
  std::iota(after.begin(), after.end(), std::size_t{1});
  for (std::size_t i = 0; i < all.size(); ++i) before[i + 1] = i;
  before[0] = all.size();
  std::priority_queue<Neighbours, std::vector<Neighbours>, std::greater<>> nearest;
  const auto consider = [&](std::size_t left, std::size_t right) {
    if (left >= all.size() || right >= all.size() || all[left].in_first == all[right].in_first) return;
    const double difference = all[right].time - all[left].time;
    if (difference <= max_difference) nearest.push({difference, left, right});
  };
  for (std::size_t i = 0; i + 1 < all.size(); ++i) consider(i, i + 1);

  std::vector<char> taken(all.size(), 0);
  std::vector<TimePair> pairs;
  while (!nearest.empty()) {
    const auto [difference, left, right] = nearest.top();
    nearest.pop();
    if (taken[left] != 0 || taken[right] != 0) continue;
    taken[left] = taken[right] = 1;
    pairs.push_back(all[left].in_first ? TimePair{all[left].place, all[right].place}
                                       : TimePair{all[right].place, all[left].place});
    const std::size_t previous = before[left], next = after[right];
    if (previous < all.size()) after[previous] = next;
    if (next < all.size()) before[next] = previous;
    consider(previous, next);
  }
  std::sort(pairs.begin(), pairs.end());
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
