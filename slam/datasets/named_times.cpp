#include "slam/datasets/named_times.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "slam/geometry/time_unit.h"

namespace penumbra::slam {

namespace {

constexpr double kSmallestClock = 1e9;  // of whole numbers that are times
constexpr double kCountingStep = 1.5;   // numbers that are closer count frames, unless they are seconds
constexpr double kLargestSeconds = 1e10;

bool is_number(std::string_view name, std::string_view characters) {
  return !name.empty() && name.find_first_not_of(characters) == std::string_view::npos &&
         std::count(name.begin(), name.end(), '.') <= 1 && name != ".";
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

}  // namespace

std::vector<double> times_in_names(const ImagePairs& images, std::vector<std::string>& notes) {
  std::vector<FileTime> times;
  bool has_points = false, are_dates = true;
  double largest = 0.0, smallest = HUGE_VAL;
  for (const NamedImage& image : images.first) {
    if (!is_number(image.name, "0123456789.")) return {};
    times.push_back(parse_file_time(image.name, image.path.string()));
    has_points = has_points || image.name.find('.') != std::string::npos;
    are_dates = are_dates && !has_points && is_date(image.name);
    largest = std::max(largest, times.back().value);
    smallest = std::min(smallest, times.back().value);
  }
  const std::string folder = images.first.front().path.parent_path().string();
  if (are_dates) {
    notes.push_back(fmt::format("{}: images named by a date, such as '{}': not taken as times", folder,
                                images.first.front().name));
    return {};
  }
  const double step = (largest - smallest) / static_cast<double>(std::max<std::size_t>(1, times.size() - 1));
  const bool counts = times.size() > 1 && step < kCountingStep && largest >= kLargestSeconds;
  if (!has_points && (largest < kSmallestClock || counts)) return {};
  const TimeRule rule = has_points ? kCameraSeconds : TimeRule{kCameraSeconds.fastest, std::nullopt};
  const std::vector<double> seconds = to_seconds(times, rule, folder + ", names of images", notes);
  std::vector<double> chosen;
  for (const ImagePair& pair : images.pairs) chosen.push_back(seconds[pair.first]);
  return chosen;
}

}  // namespace penumbra::slam
