#include "slam/sources/named_times.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "nn/base/natural_order.h"
#include "nn/base/text.h"
#include "slam/geometry/time_unit.h"

namespace penumbra::slam {

namespace {

constexpr std::size_t kClockDigits = 10;
constexpr double kSmallestClock = 1e9;  // of whole numbers that are times
constexpr double kCountingStep = 1.5;   // numbers that are closer count frames, unless they are seconds
constexpr double kLargestSeconds = 1e10;

// A name taken apart; `whole` is empty where it has no digits.
struct NumberInName {
  std::string_view prefix, whole, fraction, suffix;
  char separator = 0;  // before the fraction: '.', '_' or '-'

  bool fits(const NumberInName& other) const { return prefix == other.prefix && suffix == other.suffix; }
  // The whole number, with the fraction behind a point.
  std::string text() const {
    std::string joined(whole);
    if (separator == '.') joined.append(1, '.').append(fraction);
    return joined;
  }
  bool is_split() const { return separator == '_' || separator == '-'; }
};

std::size_t digits_end(std::string_view name, std::size_t begin) {
  while (begin < name.size() && is_digit(name[begin])) ++begin;
  return begin;
}

// Around the first run of digits that is long enough for a clock; or else around the last run, which counts.
NumberInName find_number(std::string_view name) {
  std::size_t begin = name.size(), end = name.size();
  for (std::size_t at = 0; at < name.size();) {
    if (!is_digit(name[at])) {
      ++at;
      continue;
    }
    begin = at;
    at = end = digits_end(name, at);
    if (end - begin >= kClockDigits) break;
  }
  NumberInName found;
  // A small number with a point, which is one only if nothing else is in the name.
  const std::size_t point = name.find('.');
  const bool is_decimal = end - begin < kClockDigits && point != std::string_view::npos && name != "." &&
                          digits_end(name, 0) == point && digits_end(name, point + 1) == name.size();
  if (is_decimal) {
    begin = 0;
    end = point;
  }
  found.prefix = name.substr(0, begin);
  found.whole = name.substr(begin, end - begin);
  const std::size_t fraction_end = end < name.size() ? digits_end(name, end + 1) : end;
  bool has_fraction = is_decimal;
  if (end - begin >= kClockDigits && fraction_end > end + 1) {
    const bool is_split = (name[end] == '_' || name[end] == '-') && end - begin == kClockDigits;
    has_fraction = name[end] == '.' || is_split;
  }
  if (has_fraction) {
    found.separator = name[end];
    found.fraction = name.substr(end + 1, fraction_end - end - 1);
    end = fraction_end;
  }
  found.suffix = name.substr(end);
  return found;
}

// Of the pairs' left images.
std::vector<NumberInName> numbers_in_names(const ImagePairs& images) {
  std::vector<NumberInName> numbers;
  for (const ImagePair& pair : images.pairs) numbers.push_back(find_number(images.first[pair.first].name));
  return numbers;
}

int digits(std::string_view name, std::size_t begin, std::size_t count) {
  int value = 0;
  for (const char c : name.substr(begin, count)) value = 10 * value + (c - '0');
  return value;
}

// YYYYMMDDhhmmss, with or without milliseconds.
bool is_date(std::string_view name) {
  if (name.size() != 14 && name.size() != 17) return false;
  const auto within = [&](std::size_t begin, int least, int most) {
    const int value = digits(name, begin, 2);
    return value >= least && value <= most;
  };
  return within(0, 19, 20) && within(4, 1, 12) && within(6, 1, 31) && within(8, 0, 23) && within(10, 0, 59) &&
         within(12, 0, 60);
}

// Seconds and what follows them, "1403636570_763555580", as nanoseconds; empty where it is no part of a
// second.
std::vector<FileTime> joined_seconds(const std::vector<NumberInName>& numbers) {
  constexpr std::size_t kMicro = 6, kNano = 9;
  std::size_t fewest = kNano, most = 0;
  for (const NumberInName& number : numbers) {
    fewest = std::min(fewest, number.fraction.size());
    most = std::max(most, number.fraction.size());
  }
  const bool is_micro = fewest == kMicro && most == kMicro;
  if (!is_micro && (most > kNano || most <= kMicro)) return {};
  std::vector<FileTime> times;
  for (const NumberInName& number : numbers) {
    std::string fraction(number.fraction);
    if (is_micro) fraction += "000";
    fraction.insert(0, kNano - fraction.size(), '0');
    times.push_back(parse_file_time(std::string(number.whole) + fraction, "name"));
  }
  return times;
}

bool is_clock(const NumberInName& number) {
  const std::size_t zeros = std::min(number.whole.find_first_not_of('0'), number.whole.size());
  return number.whole.size() - zeros >= kClockDigits;
}

// The first name that is not like `clock`; none where all are.
const NumberInName* find_stray(const std::vector<NumberInName>& numbers, const NumberInName& clock) {
  const auto at = std::find_if(numbers.begin(), numbers.end(), [&](const NumberInName& number) {
    return number.whole.empty() || !number.fits(clock) || number.is_split() != clock.is_split();
  });
  return at == numbers.end() ? nullptr : &*at;
}

}  // namespace

std::vector<double> times_in_names(const ImagePairs& images, std::vector<std::string>& notes) {
  const std::vector<NumberInName> numbers = numbers_in_names(images);
  const auto name_of = [&](const NumberInName& number) {
    const auto at = static_cast<std::size_t>(&number - numbers.data());
    return printable(images.first[images.pairs[at].first].path.filename().string(), 60);
  };
  const std::string folder = images.first.front().path.parent_path().string();
  const auto clocks = std::count_if(numbers.begin(), numbers.end(), is_clock);
  const bool are_clocks = 2 * static_cast<std::size_t>(clocks) > numbers.size();
  const NumberInName& like =
      are_clocks ? *std::find_if(numbers.begin(), numbers.end(), is_clock) : numbers.front();
  const NumberInName* stray = find_stray(numbers, like);
  std::vector<FileTime> times;
  bool has_points = false, are_dates = true;
  double largest = 0.0, smallest = HUGE_VAL;
  for (const NumberInName& number : numbers) {
    if (number.whole.empty() || !number.fits(like)) continue;
    times.push_back(parse_file_time(number.text(), name_of(number)));
    has_points = has_points || number.separator == '.';
    are_dates = are_dates && !has_points && is_date(number.whole);
    largest = std::max(largest, times.back().value);
    smallest = std::min(smallest, times.back().value);
  }
  if (times.empty()) return {};
  if (are_dates) {
    notes.push_back(
        fmt::format("{}: images named by a date, such as '{}': not taken as times", folder, name_of(like)));
    return {};
  }
  const double step = (largest - smallest) / static_cast<double>(std::max<std::size_t>(1, times.size() - 1));
  const bool counts = times.size() > 1 && step < kCountingStep && largest >= kLargestSeconds;
  if (!has_points && !like.is_split() && (largest < kSmallestClock || counts)) return {};
  const auto refuse = [&](const std::string& reason) {
    notes.push_back(fmt::format("{}: names such as {} look like times and are not taken: {}", folder,
                                name_of(like), reason));
    return std::vector<double>();
  };
  if (stray != nullptr && are_clocks) return refuse(fmt::format("{} is not like them", name_of(*stray)));
  if (stray != nullptr) return {};
  std::vector<double> seconds;
  if (like.is_split()) {
    for (const FileTime& time : joined_seconds(numbers))
      seconds.push_back(to_seconds(time, TimeUnit::nanoseconds));
    if (seconds.empty())
      return refuse(
          fmt::format("after '{}' nano- (7 to 9 digits) or microseconds (6) are expected", like.separator));
    notes.push_back(fmt::format("{}, names of images: taken as seconds and their part, such as {}", folder,
                                name_of(like)));
    return seconds;
  }
  const TimeRule rule = has_points ? kCameraSeconds : TimeRule{kCameraSeconds.fastest, std::nullopt};
  return to_seconds(times, rule, folder + ", names of images", notes);
}

std::vector<double> places_in_names(const ImagePairs& images) {
  std::vector<double> places;
  for (const ImagePair& pair : images.pairs) places.push_back(static_cast<double>(pair.place));
  const std::vector<NumberInName> numbers = numbers_in_names(images);
  std::vector<std::int64_t> values, steps;
  for (const NumberInName& number : numbers) {
    if (number.whole.empty() || number.separator != 0 || !number.fits(numbers.front())) return places;
    const FileTime value = parse_file_time(number.whole, "name");
    if (!value.whole || value.value >= kSmallestClock) return places;
    if (!values.empty()) steps.push_back(*value.whole - values.back());
    values.push_back(*value.whole);
  }
  if (steps.size() < 2) return places;
  std::vector<std::int64_t> ordered = steps;
  const auto middle = ordered.begin() + static_cast<std::ptrdiff_t>((ordered.size() - 1) / 2);
  std::nth_element(ordered.begin(), middle, ordered.end());
  const std::int64_t usual = *middle;
  const bool are_multiples = usual > 0 && std::all_of(steps.begin(), steps.end(), [&](std::int64_t step) {
                               return step > 0 && step % usual == 0;
                             });
  if (!are_multiples) return places;
  for (std::size_t i = 1; i < places.size(); ++i)
    places[i] = places[0] + static_cast<double>((values[i] - values[0]) / usual);
  return places;
}

}  // namespace penumbra::slam
