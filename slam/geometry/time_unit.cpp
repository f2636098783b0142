#include "slam/geometry/time_unit.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "nn/base/error.h"
#include "nn/base/number_file.h"

namespace penumbra::slam {

namespace {

constexpr TimeUnit kUnits[] = {TimeUnit::seconds, TimeUnit::milliseconds, TimeUnit::microseconds,
                               TimeUnit::nanoseconds};
constexpr std::int64_t kPerSecond[] = {1, 1'000, 1'000'000, 1'000'000'000};

// Seconds since 1970 between 1985 and 2128.
constexpr double kEarliest = 5e8, kLatest = 5e9;
constexpr double kSlowest = 20.0;       // seconds, the longest step that is believed
constexpr double kSlowestWhole = 5.0;   // the same where seconds are whole numbers, which may be another unit
constexpr double kOutlandish = 5.0;     // a step may be so many times shorter than the fastest
constexpr double kCountingStep = 10.0;  // whole numbers closer than this count frames, or seconds
constexpr double kDay = 86400.0;        // seconds

std::int64_t per_second(TimeUnit unit) { return kPerSecond[static_cast<std::size_t>(unit)]; }

// The median of the steps between times that differ; none where no two do.
std::optional<double> usual_step(std::span<const FileTime> times) {
  std::vector<FileTime> ordered(times.begin(), times.end());
  const auto is_whole = [](const FileTime& t) { return t.whole.has_value(); };
  const bool all_whole = std::all_of(ordered.begin(), ordered.end(), is_whole);
  std::sort(ordered.begin(), ordered.end(), [&](const FileTime& a, const FileTime& b) {
    return all_whole ? *a.whole < *b.whole : a.value < b.value;
  });
  std::vector<double> steps;
  for (std::size_t i = 1; i < ordered.size(); ++i) {
    const double step =
        all_whole ? static_cast<double>(*ordered[i].whole) - static_cast<double>(*ordered[i - 1].whole)
                  : ordered[i].value - ordered[i - 1].value;
    if (step > 0.0) steps.push_back(step);
  }
  if (steps.empty()) return std::nullopt;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>((steps.size() - 1) / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

double largest(std::span<const FileTime> times) {
  double most = 0.0;
  for (const FileTime& t : times) most = std::max(most, std::abs(t.value));
  return most;
}

// The unit in which the times are those of a calendar.
std::optional<TimeUnit> calendar_unit(double value) {
  for (const TimeUnit unit : kUnits) {
    const double seconds = value / static_cast<double>(per_second(unit));
    if (seconds >= kEarliest && seconds < kLatest) return unit;
  }
  return std::nullopt;
}

}  // namespace

const char* to_string(TimeUnit unit) {
  static constexpr const char* kNames[] = {"seconds", "milliseconds", "microseconds", "nanoseconds"};
  return kNames[static_cast<std::size_t>(unit)];
}

FileTime parse_file_time(std::string_view text, std::string_view place) {
  std::int64_t whole = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
  if (error == std::errc() && end == text.data() + text.size()) return {static_cast<double>(whole), whole};
  const std::vector<double> numbers = nn::parse_numbers(text, place);
  if (numbers.size() != 1) throw InputError(place, "a time", numbers.empty() ? "nothing" : "several numbers");
  return to_file_time(numbers.front());
}

FileTime to_file_time(double value) {
  constexpr double kLargest = 9.2e18;  // of 64 bits
  if (value != std::floor(value) || !(std::abs(value) < kLargest)) return {value, std::nullopt};
  return {value, static_cast<std::int64_t>(value)};
}

double to_seconds(const FileTime& time, TimeUnit unit) {
  if (unit == TimeUnit::seconds) return time.value;
  const std::int64_t per = per_second(unit);
  if (!time.whole) return time.value / static_cast<double>(per);
  return static_cast<double>(*time.whole / per) +
         static_cast<double>(*time.whole % per) / static_cast<double>(per);
}

TimeUnit find_time_unit(std::span<const FileTime> times, const TimeRule& rule, std::string_view place) {
  const std::optional<TimeUnit> calendar = calendar_unit(largest(times));
  const std::optional<double> step = usual_step(times);
  if (!step) return calendar.value_or(rule.documented.value_or(TimeUnit::seconds));

  const bool fractions =
      std::any_of(times.begin(), times.end(), [](const FileTime& t) { return !t.whole.has_value(); });
  const double shortest = 1.0 / rule.fastest;
  const auto seconds = [&](TimeUnit unit) { return *step / static_cast<double>(per_second(unit)); };
  const auto is_usual = [&](TimeUnit unit) {
    return seconds(unit) >= shortest && seconds(unit) < 1000.0 * shortest;
  };
  const auto is_possible = [&](TimeUnit unit, double slowest) {
    return seconds(unit) >= shortest / kOutlandish && seconds(unit) <= slowest;
  };
  const std::optional<TimeUnit>& documented = rule.documented;
  if (calendar && is_usual(*calendar)) return *calendar;
  if (documented && is_usual(*documented)) return *documented;
  if (calendar && is_possible(*calendar, kSlowest)) return *calendar;
  if (documented && is_possible(*documented, fractions ? kSlowest : kSlowestWhole)) return *documented;
  if (!fractions && *step >= 1.0 && *step < kCountingStep) return TimeUnit::seconds;
  for (const TimeUnit unit : kUnits) {
    if (is_usual(unit)) return unit;
  }
  if (calendar && seconds(*calendar) >= shortest / kOutlandish && seconds(*calendar) <= kDay)
    return *calendar;
  throw InputError(place,
                   fmt::format("times in seconds, milli-, micro- or nanoseconds, {:g} to {:g} s apart",
                               shortest, kSlowest),
                   fmt::format("a usual step of {:g}, which is that of none of them", *step));
}

std::vector<double> to_seconds(std::span<const FileTime> times, const TimeRule& rule, std::string_view place,
                               std::vector<std::string>& notes) {
  const TimeUnit unit = find_time_unit(times, rule, place);
  std::vector<double> seconds;
  seconds.reserve(times.size());
  for (const FileTime& time : times) seconds.push_back(to_seconds(time, unit));
  if (rule.documented != unit && !times.empty()) {
    const std::optional<double> step = usual_step(times);
    notes.push_back(fmt::format(
        "{}: the times are taken as {}{}{}", place, to_string(unit),
        rule.documented ? fmt::format(" (not {})", to_string(*rule.documented)) : "",
        step ? fmt::format(": the usual step is then {:.4g} s", *step / static_cast<double>(per_second(unit)))
             : ""));
  }
  return seconds;
}

}  // namespace penumbra::slam
