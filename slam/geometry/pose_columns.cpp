#include "slam/geometry/pose_columns.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::slam {

namespace {

using Words = std::vector<std::string>;

constexpr const char* kPartNames[] = {"x", "y", "z", "qx", "qy", "qz", "qw"};
constexpr std::string_view kAxes = "xyzw";

enum class Group { none, position, quaternion, r, angles, other };

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

Group group_of(std::string_view word) {
  if (is_one_of(word,
                {"t", "p", "pos", "position", "trans", "translation", "loc", "location", "pose", "point"}))
    return Group::position;
  if (is_one_of(word, {"q", "quat", "quaternion", "orientation", "orient", "ori", "rot", "rotation"}))
    return Group::quaternion;
  if (is_one_of(word, {"euler", "rpy"})) return Group::angles;
  if (is_one_of(word, {"v", "vel",  "velocity", "speed",        "linear",     "angular", "twist",
                       "a", "acc",  "accel",    "acceleration", "omega",      "gyro",    "w",
                       "b", "bias", "g",        "cov",          "covariance", "std",     "sigma"})) {
    return Group::other;
  }
  return Group::none;
}

std::optional<TimeUnit> unit_of(std::string_view word) {
  if (is_one_of(word, {"s", "sec", "secs", "second", "seconds"})) return TimeUnit::seconds;
  if (is_one_of(word, {"ms", "msec", "millisec", "milliseconds"})) return TimeUnit::milliseconds;
  if (is_one_of(word, {"us", "usec", "microsec", "microseconds"})) return TimeUnit::microseconds;
  if (is_one_of(word, {"ns", "nsec", "nsecs", "nanosec", "nanosecs", "nanoseconds"}))
    return TimeUnit::nanoseconds;
  return std::nullopt;
}

// The words of a name in lower case, the axis the last: "p_RS_R_x [m]" p rs r x, "positionX" and "x_position"
// position x.
struct ColumnName {
  Words words;
  std::string unit;
};

ColumnName parse_name(std::string_view text) {
  ColumnName name;
  const std::size_t bracket = std::min(text.find_first_of("[("), text.size());
  for (const char c : text.substr(bracket)) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0) name.unit += lower_case(c);
  }
  bool was_lower = false, inside = false;
  for (const char c : text.substr(0, bracket)) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) == 0) {
      inside = was_lower = false;
      continue;
    }
    if (!inside || (was_lower && std::isupper(byte) != 0)) name.words.emplace_back();
    inside = true;
    was_lower = std::islower(byte) != 0;
    name.words.back() += lower_case(c);
  }
  if (!name.words.empty() && is_one_of(name.words.back(), {"m", "meters", "metres"})) name.words.pop_back();
  const auto is_axis = [](const std::string& word) {
    return word.size() == 1 && kAxes.find(word.front()) != std::string_view::npos;
  };
  if (name.words.size() == 2 && is_axis(name.words.front()) && !is_axis(name.words.back()))
    std::swap(name.words.front(), name.words.back());
  return name;
}

// What a name says: which part, and whether it says so clearly.
struct Part {
  Group group = Group::none;
  std::size_t axis = 0;
  bool is_clear = false;
};

Part part_of(const ColumnName& name) {
  if (name.words.empty()) return {};
  const std::string& last = name.words.back();
  if (is_one_of(last, {"roll", "pitch", "yaw", "heading"})) return {Group::angles, 0, true};
  const std::size_t axis = kAxes.find(last.back());
  if (axis == std::string_view::npos) return {};
  const std::string_view rest = std::string_view(last).substr(0, last.size() - 1);
  const bool has_r = rest == "r" || (rest.empty() && name.words.size() == 2 && name.words.front() == "r");
  if (has_r) return {Group::r, axis, true};
  if (!rest.empty()) return {group_of(rest), axis, true};
  for (auto word = name.words.rbegin() + 1; word != name.words.rend(); ++word) {
    if (const Group group = group_of(*word); group != Group::none) return {group, axis, true};
  }
  return {axis == 3 ? Group::quaternion : Group::position, axis, name.words.size() == 1};
}

struct Found {
  std::optional<std::size_t> at;
  bool is_clear = false;
  std::optional<std::size_t> twice;
};

struct FoundParts {
  std::array<Found, 7> parts;  // as kPartNames
  Words angles;
  std::size_t count(std::size_t begin, std::size_t end) const {
    return static_cast<std::size_t>(std::count_if(parts.begin() + static_cast<std::ptrdiff_t>(begin),
                                                  parts.begin() + static_cast<std::ptrdiff_t>(end),
                                                  [](const Found& found) { return found.at.has_value(); }));
  }
};

FoundParts find_parts(const Words& names) {
  std::vector<Part> parts;
  for (const std::string& name : names) parts.push_back(part_of(parse_name(name)));
  const bool has_rw = std::any_of(parts.begin(), parts.end(),
                                  [](const Part& part) { return part.group == Group::r && part.axis == 3; });
  FoundParts found;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Group group = parts[i].group;
    if (group == Group::r) group = has_rw ? Group::quaternion : Group::angles;
    if (group == Group::angles) found.angles.push_back(printable(names[i], 40));
    if (group != Group::quaternion && (group != Group::position || parts[i].axis == 3)) continue;
    Found& part = found.parts[(group == Group::quaternion ? 3 : 0) + parts[i].axis];
    if (part.at && part.is_clear == parts[i].is_clear) part.twice = i;
    if (part.at && part.is_clear >= parts[i].is_clear) continue;
    part = {i, parts[i].is_clear, std::nullopt};
  }
  return found;
}

void find_time(const Words& names, PoseColumns& columns) {
  enum { kNone, kIndex, kSeconds, kTime, kStamp };
  int best = kNone;
  std::optional<std::size_t> nanoseconds;
  for (std::size_t i = 0; i < names.size(); ++i) {
    ColumnName name = parse_name(names[i]);
    std::optional<TimeUnit> unit = unit_of(name.unit);
    if (!unit && !name.words.empty() && (unit = unit_of(name.words.back()))) {
      if (*unit == TimeUnit::nanoseconds && name.words.back() != "ns" && !nanoseconds) nanoseconds = i;
      if (name.words.size() > 1) name.words.pop_back();
    }
    const std::string word = name.words.empty() ? "" : name.words.back();
    int rank = kNone;
    if (is_one_of(word, {"timestamp", "timestamps", "stamp", "ts"})) {
      rank = kStamp;
    } else if (is_one_of(word, {"t", "time", "times"})) {
      rank = kTime;
    } else if (unit_of(word)) {
      rank = kSeconds;
    } else if (is_one_of(word, {"", "frame", "frames", "idx", "index", "id", "seq"})) {
      rank = kIndex;
    }
    const bool is_seconds_after_nanoseconds =
        rank == best && unit == TimeUnit::seconds && columns.time == nanoseconds;
    if (rank == kNone || rank < best || (rank == best && !is_seconds_after_nanoseconds)) continue;
    best = rank;
    columns.time = i;
    columns.unit = unit;
    columns.time_is_index = rank == kIndex;
  }
  if (nanoseconds && columns.time && *nanoseconds != *columns.time && columns.unit == TimeUnit::seconds)
    columns.nanoseconds = nanoseconds;
}

}  // namespace

std::vector<std::string> column_names(std::string_view header) {
  header.remove_prefix(std::min(header.find_first_not_of("#%/ \t"), header.size()));
  if (const std::size_t colon = header.rfind(": "); colon != std::string_view::npos)
    header.remove_prefix(colon + 2);
  // Units belong to the name before them, with all their blanks.
  std::string text;
  int depth = 0;
  for (const char c : header) {
    if (c == '"' || c == '\'' || c == '\r') continue;
    const bool opens = c == '[' || c == '(', closes = c == ']' || c == ')';
    if (opens) {
      while (!text.empty() && text.back() == ' ') text.pop_back();
      ++depth;
    }
    if (closes && depth > 0) --depth;
    text += depth > 0 && (c == ' ' || c == '\t' || c == ',') ? '_' : c;
  }
  const std::string_view separators = text.find(';') != std::string::npos   ? ";"
                                      : text.find(',') != std::string::npos ? ","
                                                                            : " \t";
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    std::string name = text.substr(begin, end - begin);
    begin = end + 1;
    name.erase(0, std::min(name.find_first_not_of(" \t"), name.size()));
    name.erase(name.find_last_not_of(" \t") + 1);
    if (!name.empty() || separators.size() == 1) names.push_back(std::move(name));
  }
  while (!names.empty() && names.back().empty()) names.pop_back();
  return names;
}

std::size_t PoseColumns::end() const {
  std::size_t last = std::max(*std::max_element(position.begin(), position.end()),
                              *std::max_element(quaternion.begin(), quaternion.end()));
  if (time) last = std::max(last, *time);
  if (nanoseconds) last = std::max(last, *nanoseconds);
  return last + 1;
}

std::vector<std::string> PoseColumns::left_out() const {
  Words left;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_used = i == time || i == nanoseconds ||
                         std::find(position.begin(), position.end(), i) != position.end() ||
                         std::find(quaternion.begin(), quaternion.end(), i) != quaternion.end();
    const auto begins = [&](const char* prefix) { return names[i].rfind(prefix, 0) == 0; };
    const bool is_usual = begins("v_RS_") || begins("b_w_RS_") || begins("b_a_RS_");
    if (!is_used && !is_usual)
      left.push_back(names[i].empty() ? "one without name" : printable(names[i], 40));
  }
  return left;
}

std::optional<PoseColumns> find_pose_columns(const std::vector<std::string>& names, bool is_comment,
                                             const std::string& place) {
  const FoundParts found = find_parts(names);
  const std::size_t of_position = found.count(0, 3), of_quaternion = found.count(3, 7);
  const std::size_t angles = found.angles.size();
  const bool has_most = of_position > 0 && of_quaternion > 0 && of_position + of_quaternion >= 5;
  if (is_comment && !has_most && !(of_position == 3 && angles >= 2)) return std::nullopt;
  if (of_position + of_quaternion == 0) return std::nullopt;

  const std::string expected = "columns of x y z and of a quaternion qx qy qz qw";
  if (of_position == 3 && of_quaternion < 4 && angles > 0) {
    throw InputError(place, expected,
                     fmt::format("angles ({}) and no quaternion", fmt::join(found.angles, ", ")));
  }
  PoseColumns columns;
  columns.names = names;
  find_time(names, columns);
  for (std::size_t part = 0; part < found.parts.size(); ++part) {
    const auto& [at, is_clear, twice] = found.parts[part];
    if (!at) {
      throw InputError(place, expected,
                       fmt::format("no {} among {}", kPartNames[part],
                                   printable(fmt::format("{}", fmt::join(names, ", ")), 200)));
    }
    if (twice) {
      throw InputError(place, expected,
                       fmt::format("two of {}: '{}' and '{}'", kPartNames[part], printable(names[*at], 40),
                                   printable(names[*twice], 40)));
    }
    (part < 3 ? columns.position[part] : columns.quaternion[part - 3]) = *at;
  }
  return columns;
}

std::optional<bool> is_w_first(const std::vector<std::string>& names) {
  const FoundParts found = find_parts(names);
  if (!found.parts[3].at || !found.parts[6].at) return std::nullopt;
  return *found.parts[6].at < *found.parts[3].at;
}

}  // namespace penumbra::slam
