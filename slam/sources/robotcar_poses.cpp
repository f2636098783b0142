#include "slam/sources/robotcar_poses.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "nn/base/error.h"
#include "nn/base/number_file.h"
#include "nn/base/text.h"

namespace penumbra::slam {

namespace {

namespace fs = std::filesystem;

std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    words.emplace_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

// The numbers in some columns of a file whose first line names them.
class Columns {
 public:
  Columns(const fs::path& path, std::vector<std::string> wanted)
      : lines_(path, "RobotCar's poses, with a line of names"), wanted_(std::move(wanted)) {
    const std::vector<std::string> names = split(lines_.next().value_or(""));
    for (const std::string& column : wanted_) {
      const auto at = std::find(names.begin(), names.end(), column);
      if (at == names.end())
        throw InputError(path.string() + ":1", fmt::format("a column {}", column), "no such");
      places_.push_back(static_cast<std::size_t>(at - names.begin()));
    }
    columns_ = names.size();
  }

  // Of the next line, in the order they are wanted in; nothing at the end.
  std::optional<std::vector<double>> next() {
    const std::optional<std::string_view> line = lines_.next();
    if (!line) return std::nullopt;
    const std::vector<std::string> words = split(*line);
    if (words.size() < columns_)
      throw InputError(lines_.place(), fmt::format("{} columns", columns_), fmt::format("{}", words.size()));
    std::vector<double> numbers;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const std::vector<double> value = nn::parse_numbers(words[places_[i]], lines_.place());
      if (value.size() != 1)
        throw InputError(lines_.place(), fmt::format("one number as {}", wanted_[i]),
                         fmt::format("'{}'", printable(words[places_[i]], 40)));
      numbers.push_back(value.front());
    }
    return numbers;
  }

 private:
  nn::LineReader lines_;
  std::vector<std::string> wanted_;
  std::vector<std::size_t> places_;  // of the wanted columns in a line
  std::size_t columns_ = 0;
};

}  // namespace

SE3 robotcar_motion(const double* v) {
  return {so3_from_roll_pitch_yaw(v[3], v[4], v[5]), {v[0], v[1], v[2]}};
}

Trajectory read_robotcar_inertial(const fs::path& path) {
  Trajectory poses;
  Columns columns(path, {"timestamp", "northing", "easting", "down", "roll", "pitch", "yaw"});
  while (const auto v = columns.next())
    poses.push_back({kRobotCarTime * v->front(), robotcar_motion(v->data() + 1)});
  return poses;
}

Trajectory read_robotcar_odometry(const fs::path& path) {
  Trajectory poses;
  Columns steps(path, {"destination_timestamp", "source_timestamp", "x", "y", "z", "roll", "pitch", "yaw"});
  while (const auto v = steps.next()) {
    if (poses.empty()) poses.push_back({kRobotCarTime * v->front(), {}});
    SE3 T = poses.back().T_wc * robotcar_motion(v->data() + 2);
    T.normalize();
    poses.push_back({kRobotCarTime * (*v)[1], T});
  }
  return poses;
}

Trajectory interpolated(const Trajectory& poses, const std::vector<double>& times) {
  constexpr double kMostApart = 0.2;  // seconds
  Trajectory at_frames;
  for (const double time : times) {
    const auto after = std::lower_bound(poses.begin(), poses.end(), time,
                                        [](const TimedPose& pose, double t) { return pose.timestamp < t; });
    if (after == poses.end() || (after == poses.begin() && after->timestamp != time)) continue;
    if (after->timestamp == time) {
      at_frames.push_back(*after);
      continue;
    }
    const TimedPose &a = *std::prev(after), &b = *after;
    const double apart = b.timestamp - a.timestamp;
    if (!(apart <= kMostApart)) continue;
    const double share = (time - a.timestamp) / apart;
    const Eigen::Quaterniond from(a.T_wc.rotation), to(b.T_wc.rotation);
    at_frames.push_back({time,
                         {from.slerp(share, to).toRotationMatrix(),
                          a.T_wc.translation + share * (b.T_wc.translation - a.T_wc.translation)}});
  }
  return at_frames;
}

}  // namespace penumbra::slam
