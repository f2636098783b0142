#include "slam/world/route.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

#include "nn/base/error.h"
#include "slam/world/noise.h"

namespace penumbra::slam::synthetic {

namespace {

constexpr double kStep = 0.8;       // metres per frame of the built-in drives
constexpr double kSpacing = 1.0;    // metres between the points of a route
constexpr double kSmoothing = 4.0;  // metres: half width of the average that turns poses into a route

// What a pose file may ask for: a street is built along all of it.
constexpr double kLongestStep = 20.0, kLongestDrive = 20000.0;  // metres

Eigen::Vector2d direction_of(double heading) { return {std::sin(heading), std::cos(heading)}; }

// A path of straights and right-angle bends, drawn as it is driven.
class PathDrawer {
 public:
  void straight(double length) {
    const int steps = static_cast<int>(std::ceil(length / kSpacing));
    for (int i = 0; i < steps; ++i) {
      points_.push_back(position_);
      position_ += direction_of(heading_) * (length / steps);
    }
  }
  // To the right for side = 1, to the left for -1.
  void bend(int side) {
    const double angle = 0.5 * std::numbers::pi * side;
    const int steps = static_cast<int>(std::ceil(0.5 * std::numbers::pi * kBendRadius / kSpacing));
    const auto to_path = [&](double h) -> Eigen::Vector2d {
      return -side * kBendRadius * Eigen::Vector2d(std::cos(h), -std::sin(h));
    };
    const Eigen::Vector2d centre = position_ - to_path(heading_);
    for (int i = 0; i < steps; ++i) points_.push_back(centre + to_path(heading_ + angle * i / steps));
    heading_ += angle;
    position_ = centre + to_path(heading_);
  }
  std::vector<Eigen::Vector2d> take() { return std::move(points_); }

 private:
  static constexpr double kBendRadius = 11.0;  // metres
  std::vector<Eigen::Vector2d> points_;
  Eigen::Vector2d position_ = Eigen::Vector2d::Zero();
  double heading_ = 0.0;
};

// Once round a rectangle with rounded corners, starting 34 m before the first right-hand bend.
std::vector<Eigen::Vector2d> block_points() {
  constexpr double kAhead = 34.0, kLong = 74.0, kShort = 52.0;
  PathDrawer path;
  path.straight(kAhead);
  for (const double side : {kShort, kLong, kShort}) {
    path.bend(1);
    path.straight(side);
  }
  path.bend(1);
  path.straight(kLong - kAhead);
  return path.take();
}

// Two squares that share a corner, where the path goes straight on both times: three bends to the right round
// the one, three to the left round the other.
std::vector<Eigen::Vector2d> eight_points() {
  constexpr double kToCrossing = 40.0, kArm = 50.0, kSide = 39.0;
  PathDrawer path;
  path.straight(kToCrossing + kArm);
  for (const int side : {1, -1}) {
    path.bend(side);
    path.straight(kSide);
    path.bend(side);
    path.straight(kSide);
    path.bend(side);
    path.straight(side == 1 ? 2.0 * kArm : kArm - kToCrossing);
  }
  return path.take();
}

// Points about kSpacing apart along the driven positions, averaged over +-kSmoothing and lengthened straight
// on by kRouteMargin at both ends.
std::vector<Eigen::Vector2d> route_through(const std::vector<GroundPose>& driven) {
  std::vector<Eigen::Vector2d> picked{driven.front().position};
  for (const GroundPose& pose : driven) {
    const Eigen::Vector2d step = pose.position - picked.back();
    const int pieces = static_cast<int>(step.norm() / kSpacing);
    const Eigen::Vector2d from = picked.back();
    for (int i = 1; i <= pieces; ++i) picked.push_back(from + step * (static_cast<double>(i) / pieces));
  }
  const auto lengthen = [](const Eigen::Vector2d& end, const Eigen::Vector2d& outward) {
    std::vector<Eigen::Vector2d> points;
    for (double s = kSpacing; s <= kRouteMargin; s += kSpacing) points.push_back(end + s * outward);
    return points;
  };
  std::vector<Eigen::Vector2d> points = lengthen(picked.front(), -direction_of(driven.front().heading));
  std::reverse(points.begin(), points.end());
  points.insert(points.end(), picked.begin(), picked.end());
  const auto beyond = lengthen(picked.back(), direction_of(driven.back().heading));
  points.insert(points.end(), beyond.begin(), beyond.end());

  const int reach = static_cast<int>(kSmoothing / kSpacing), n = static_cast<int>(points.size());
  std::vector<Eigen::Vector2d> smooth;
  for (int i = 0; i < n; ++i) {
    const int r = std::min({reach, i, n - 1 - i});
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int k = i - r; k <= i + r; ++k) sum += points[static_cast<std::size_t>(k)];
    sum /= 2.0 * r + 1.0;
    if (smooth.empty() || (sum - smooth.back()).norm() > 0.2 * kSpacing) smooth.push_back(sum);
  }
  return smooth;
}

std::vector<SE3> read_poses(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw InputError(file.string(), "a KITTI pose file", "no readable file");
  std::vector<SE3> poses;
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    const std::string place = fmt::format("{}, line {}", file.string(), number);
    std::istringstream words(line);
    std::vector<double> values;
    std::string word;
    while (words >> word) {
      char* end = nullptr;
      const double value = std::strtod(word.c_str(), &end);
      if (*end != '\0' || !std::isfinite(value) || std::abs(value) > 1e5) {
        throw InputError(place, "finite numbers up to 100000", "'" + word.substr(0, 40) + "'");
      }
      values.push_back(value);
    }
    if (values.empty()) continue;
    if (values.size() != 12) throw InputError(place, "12 numbers", fmt::format("{}", values.size()));
    SE3 pose;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) pose.rotation(r, c) = values[static_cast<std::size_t>(4 * r + c)];
      pose.translation[r] = values[static_cast<std::size_t>(4 * r + 3)];
    }
    if ((pose.rotation * pose.rotation.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-2) {
      throw InputError(place, "a rotation in the left 3x3 part", "a matrix that is not orthogonal");
    }
    poses.push_back(pose);
  }
  double length = 0.0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double step = (poses[i].translation - poses[i - 1].translation).norm();
    length += step;
    if (step > kLongestStep) {
      throw InputError(fmt::format("{}, pose {}", file.string(), i),
                       fmt::format("at most {} m from the pose before", kLongestStep),
                       fmt::format("{:.1f} m", step));
    }
  }
  if (length > kLongestDrive) {
    throw InputError(file.string(), fmt::format("a drive of at most {} m", kLongestDrive),
                     fmt::format("{:.0f} m", length));
  }
  if (poses.empty()) throw InputError(file.string(), "at least one pose", "none");
  return poses;
}

void add_frame(Drive& drive, const GroundPose& ground, double arc) {
  drive.poses.push_back({static_cast<double>(drive.poses.size()) / kFrameRate, camera_pose(ground, arc)});
  drive.arc.push_back(arc);
}

}  // namespace

Route::Route(std::vector<Eigen::Vector2d> points, bool closed) : points_(std::move(points)), closed_(closed) {
  if (closed_) points_.push_back(points_.front());
  arc_.assign(points_.size(), 0.0);
  for (std::size_t i = 1; i < points_.size(); ++i) {
    arc_[i] = arc_[i - 1] + (points_[i] - points_[i - 1]).norm();
  }
}

GroundPose Route::at(double s, double right) const {
  if (closed_) s -= std::floor(s / length()) * length();
  const auto next = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, s);
  const std::size_t i = static_cast<std::size_t>(next - arc_.begin()) - 1;
  const std::size_t n = points_.size();
  const Eigen::Vector2d along = (points_[i + 1] - points_[i]) / (arc_[i + 1] - arc_[i]);
  // The heading turns evenly within a segment, from the mean direction at its one end to that at the other.
  const auto tangent = [&](std::size_t k) -> Eigen::Vector2d {
    if (closed_ && (k == 0 || k == n - 1)) return points_[1] - points_[n - 2];
    return points_[std::min(k + 1, n - 1)] - points_[k == 0 ? 0 : k - 1];
  };
  const double f = std::clamp((s - arc_[i]) / (arc_[i + 1] - arc_[i]), 0.0, 1.0);
  const Eigen::Vector2d facing = (1.0 - f) * tangent(i).normalized() + f * tangent(i + 1).normalized();
  GroundPose pose;
  pose.heading = std::atan2(facing.x(), facing.y());
  pose.position = points_[i] + along * (s - arc_[i]) +
                  right * Eigen::Vector2d(std::cos(pose.heading), -std::sin(pose.heading));
  return pose;
}

double Route::nearest_arc(const Eigen::Vector2d& position, double from, double to) const {
  double best = from, best_distance = std::numeric_limits<double>::infinity();
  auto i = static_cast<std::size_t>(
      std::max<std::ptrdiff_t>(0, std::upper_bound(arc_.begin(), arc_.end(), from) - arc_.begin() - 1));
  for (; i + 1 < points_.size() && arc_[i] <= to; ++i) {
    const Eigen::Vector2d edge = points_[i + 1] - points_[i];
    const double f = std::clamp((position - points_[i]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    const double distance = (points_[i] + f * edge - position).squaredNorm();
    if (distance < best_distance) {
      best_distance = distance;
      best = arc_[i] + f * edge.norm();
    }
  }
  return best;
}

SE3 camera_pose(const GroundPose& ground, double arc) {
  const auto sway = [&](float wavelength, std::uint32_t seed) {
    return static_cast<double>(value_noise(static_cast<float>(arc) / wavelength, 0.5F, seed));
  };
  const double heave = 0.015 * sway(5.0F, 11), pitch = 0.006 * sway(7.0F, 12), roll = 0.005 * sway(9.0F, 13);
  SE3 pose;
  pose.rotation =
      (Eigen::AngleAxisd(ground.heading, Eigen::Vector3d::UnitY()) *
       Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  pose.translation = {ground.position.x(), heave - kCameraHeight, ground.position.y()};
  return pose;
}

Drive make_drive(const std::string& path_name, int frames) {
  Drive drive;
  double start = 0.0;
  if (path_name == "block") {
    drive.route = Route(block_points(), true);
  } else if (path_name == "eight") {
    drive.route = Route(eight_points(), true);
  } else if (path_name == "straight") {
    const double length = kStep * frames;
    drive.route = Route(route_through({{{0.0, 0.0}, 0.0}, {{0.0, length}, 0.0}}));
    start = kRouteMargin;
  } else if (path_name == "corner") {
    const double half = 0.5 * kStep * frames;
    drive.route =
        Route(route_through({{{0.0, 0.0}, 0.0}, {{0.0, half}, 0.0}, {{half, half}, 0.5 * std::numbers::pi}}));
    start = kRouteMargin;
  } else {
    throw UsageError(fmt::format(
        "--path: expected 'block', 'eight', 'straight', 'corner' or a KITTI pose file, found '{}'",
        path_name));
  }
  for (int i = 0; i < frames; ++i) {
    const double arc = start + kStep * i;
    add_frame(drive, drive.route.at(arc), arc);
  }
  return drive;
}

Drive load_drive(const std::filesystem::path& file, int frames) {
  std::vector<SE3> poses = read_poses(file);
  if (frames > static_cast<int>(poses.size())) {
    throw UsageError(
        fmt::format("--frames: {} asked for, {} has {} poses", frames, file.string(), poses.size()));
  }
  std::vector<GroundPose> driven;
  for (const SE3& pose : poses) {
    const Eigen::Vector3d forward = pose.rotation.col(2);
    driven.push_back({{pose.translation.x(), pose.translation.z()}, std::atan2(forward.x(), forward.z())});
  }
  Drive drive;
  drive.route = Route(route_through(driven));
  double arc = kRouteMargin;
  const std::size_t count = frames == 0 ? poses.size() : static_cast<std::size_t>(frames);
  for (std::size_t i = 0; i < count; ++i) {
    // Only near the frame before: elsewhere the route may cross or follow itself.
    const double step = i == 0 ? 0.0 : (driven[i].position - driven[i - 1].position).norm();
    arc = drive.route.nearest_arc(driven[i].position, arc - step - 3.0, arc + step + 3.0);
    add_frame(drive, driven[i], arc);
  }
  return drive;
}

}  // namespace penumbra::slam::synthetic
