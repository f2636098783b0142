#include "slam/brain/motion/odometry_file.h"

#include <algorithm>
#include <cmath>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/number_file.h"

namespace penumbra::slam::brain {

namespace {

constexpr const char* kRecord = "time v omega (seconds, metres a second, radians a second)";
constexpr double kNanoseconds = 1e14;  // no clock counts so many seconds
// Nothing on wheels is so fast, and nothing at all: metres and radians a second.
constexpr double kUnlikelySpeed = 60.0, kUnlikelyTurnRate = 12.0;
constexpr double kMostSpeed = 1000.0, kMostTurnRate = 1000.0;

// What lies between `from` and `until` while a sample of `gap` seconds holds: it moves for kLongestGap and
// stands then.
void add_motion(const OdometrySample& sample, double from, double until, std::vector<SelfMotion>& motions) {
  const double moves_until = std::min(until, sample.time + kLongestGap);
  if (moves_until > from) motions.push_back({sample.speed, sample.turn_rate, moves_until - from});
  const double stands_from = std::max(from, moves_until);
  if (until > stands_from) motions.push_back({0.0, 0.0, until - stands_from});
}

}  // namespace

std::vector<OdometrySample> read_odometry(const std::filesystem::path& path) {
  nn::LineReader lines(path, "wheel odometry");
  std::vector<OdometrySample> samples;
  while (const std::optional<std::string_view> line = lines.next()) {
    std::string text(*line);
    std::replace(text.begin(), text.end(), ',', ' ');
    const std::vector<double> values = nn::parse_numbers(text, lines.place());
    if (values.size() != 3) {
      throw InputError(lines.place(), kRecord, counted(values.size(), "number"));
    }
    const double time = values[0] > kNanoseconds ? values[0] * 1e-9 : values[0];
    if (!samples.empty() && !(time > samples.back().time)) {
      throw InputError(lines.place(), fmt::format("a time after {:.6f} s", samples.back().time),
                       fmt::format("{:.6f} s", time));
    }
    if (std::abs(values[1]) > kMostSpeed || std::abs(values[2]) > kMostTurnRate) {
      throw InputError(lines.place(),
                       fmt::format("at most {:g} m/s and {:g} rad/s", kMostSpeed, kMostTurnRate),
                       fmt::format("{:g} and {:g}", values[1], values[2]));
    }
    samples.push_back({time, values[1], values[2]});
  }
  if (samples.size() < 2) {
    throw InputError(path.string(), fmt::format("at least two lines of {}", kRecord),
                     fmt::format("{}", samples.size()));
  }
  return samples;
}

OdometryOfFrames odometry_of_frames(const std::vector<OdometrySample>& samples,
                                    const std::vector<double>& times, const std::string& place) {
  if (times.empty() || samples.front().time > times.back() || samples.back().time < times.front()) {
    throw InputError(
        place,
        times.empty() ? std::string("frames")
                      : fmt::format("times of the images, {:.3f} to {:.3f} s", times.front(), times.back()),
        fmt::format("{:.3f} to {:.3f} s", samples.front().time, samples.back().time));
  }
  OdometryOfFrames of;
  of.motions.resize(times.size());
  std::size_t s = 0;
  double longest_gap = 0.0;
  int uncovered = 0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    double from = times[i - 1];
    std::vector<SelfMotion>& motions = of.motions[i];
    // Before the first sample nothing is known; it is believed for as long as any other.
    if (from < samples.front().time) {
      const double until = std::min(times[i], samples.front().time);
      const double known_from = std::clamp(samples.front().time - kLongestGap, from, until);
      if (known_from > from) motions.push_back({0.0, 0.0, known_from - from});
      if (until > known_from)
        motions.push_back({samples.front().speed, samples.front().turn_rate, until - known_from});
      from = until;
    }
    while (from < times[i]) {
      while (s + 1 < samples.size() && samples[s + 1].time <= from) ++s;
      const double until = s + 1 < samples.size() ? std::min(times[i], samples[s + 1].time) : times[i];
      add_motion(samples[s], from, until, motions);
      longest_gap = std::max(longest_gap, until - samples[s].time);
      from = until;
    }
    uncovered += times[i] < samples.front().time || times[i - 1] > samples.back().time;
  }
  if (longest_gap > kLongestGap) {
    of.notes.push_back(fmt::format(
        "{}: gaps of up to {:.2f} s; for what of one is beyond {:g} s the robot is taken to stand still (are "
        "the times seconds?)",
        place, longest_gap, kLongestGap));
  }
  if (uncovered > 0) {
    of.notes.push_back(fmt::format("{}: before its first or after its last sample: {} of {}", place,
                                   uncovered, counted(times.size(), "frame")));
  }
  double fastest = 0.0, speed = 0.0;
  for (const OdometrySample& sample : samples) {
    fastest = std::max(fastest, std::abs(sample.turn_rate));
    speed = std::max(speed, std::abs(sample.speed));
  }
  if (speed > kUnlikelySpeed) {
    of.notes.push_back(
        fmt::format("{}: up to {:.0f} metres a second; are these another unit?", place, speed));
  }
  if (speed == 0.0) of.notes.push_back(fmt::format("{}: the speed is 0 in every line", place));
  if (fastest > kUnlikelyTurnRate) {
    of.notes.push_back(
        fmt::format("{}: turns at up to {:.0f} radians a second; are these degrees?", place, fastest));
  }
  return of;
}

}  // namespace penumbra::slam::brain
