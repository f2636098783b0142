// The unit of times in files: seconds, or whole milli-, micro- or nanoseconds, which no file says.
//
// Two things tell it. An absolute clock counts from 1970, so that the size of a number names its unit: 10
// digits are seconds, 13 milli-, 16 micro- and 19 nanoseconds. And the usual (median) step between two times
// must be one that a camera, or who tracks a pose, can have: of the units, each 1000 times another, one fits.
// Where both agree there is no doubt. Else the step decides, the unit that the format documents coming first,
// so that a clock that counts from when it was switched on is read right, too.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace penumbra::slam {

enum class TimeUnit { seconds, milliseconds, microseconds, nanoseconds };
const char* to_string(TimeUnit unit);

// A time as it stands in a file. Whole numbers keep all their digits: nanoseconds since 1970 have more than a
// double.
struct FileTime {
  double value = 0.0;
  std::optional<std::int64_t> whole;
};

// Throws InputError naming `place` for what is no finite number.
FileTime parse_file_time(std::string_view text, std::string_view place);
FileTime to_file_time(double value);
// Exact to a rounding of the result.
double to_seconds(const FileTime& time, TimeUnit unit);

// What is known of the times of one file.
struct TimeRule {
  double fastest = 400.0;              // Hz, of the usual step
  std::optional<TimeUnit> documented;  // what the format says; none: image names
};
inline constexpr TimeRule kCameraSeconds{400.0, TimeUnit::seconds};
inline constexpr TimeRule kCameraNanoseconds{400.0, TimeUnit::nanoseconds};
inline constexpr TimeRule kPoseSeconds{2000.0, TimeUnit::seconds};
inline constexpr TimeRule kPoseNanoseconds{2000.0, TimeUnit::nanoseconds};

// The unit of `times`, in any order. Throws InputError naming `place` where no unit makes the usual step one
// of a camera or a tracker.
TimeUnit find_time_unit(std::span<const FileTime> times, const TimeRule& rule, std::string_view place);

// The times in seconds. Where the unit is not the documented one, or none is documented, `notes` gets a line
// that says which was taken and why.
std::vector<double> to_seconds(std::span<const FileTime> times, const TimeRule& rule, std::string_view place,
                               std::vector<std::string>& notes);

}  // namespace penumbra::slam
