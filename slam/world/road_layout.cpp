#include "slam/world/road_layout.h"

#include <algorithm>
#include <cmath>

#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

std::vector<Route> lay_roads(const Route& route) {
  constexpr double kSameRoad = 4.0;      // metres between centrelines that are one road
  constexpr double kNotSamePass = 40.0;  // metres along the drive before it can meet itself
  struct Sample {
    Eigen::Vector2d position;
    double heading, arc;
    bool laid = false;
  };
  std::vector<Sample> samples;
  const int count = std::max(2, static_cast<int>(route.length()));
  for (int i = 0; i <= count; ++i) {
    const double arc = route.length() * i / count;
    const GroundPose pose = route.at(arc, -static_cast<double>(kLaneCentre));
    samples.push_back({pose.position, pose.heading, arc});
  }
  if (route.closed()) {
    samples.pop_back();
    std::vector<Eigen::Vector2d> points;
    for (const Sample& sample : samples) points.push_back(sample.position);
    return {Route(points, true)};
  }
  std::vector<Route> roads;
  std::vector<Eigen::Vector2d> piece;
  const auto finish = [&] {
    if (piece.size() >= 10) roads.emplace_back(piece);
    piece.clear();
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Sample& here = samples[i];
    here.laid = true;
    for (std::size_t k = 0; k < i && here.arc - samples[k].arc > kNotSamePass; ++k) {
      const Sample& old = samples[k];
      if (old.laid && (old.position - here.position).squaredNorm() < kSameRoad * kSameRoad &&
          std::abs(std::cos(old.heading - here.heading)) > 0.9) {
        here.laid = false;
        break;
      }
    }
    if (!here.laid) {
      finish();
    } else if (piece.empty() || (piece.back() - here.position).norm() > 0.3) {
      piece.push_back(here.position);
    }
  }
  finish();
  return roads;
}

// Separating axes: two rectangles are apart where some side of one has the other wholly beyond it.
bool Footprint::overlaps(const Footprint& other) const {
  const Eigen::Vector2d between = other.centre - centre;
  for (const Eigen::Vector2d& axis : {axis_x, axis_z, other.axis_x, other.axis_z}) {
    const double reach = half_x * std::abs(axis_x.dot(axis)) + half_z * std::abs(axis_z.dot(axis)) +
                         other.half_x * std::abs(other.axis_x.dot(axis)) +
                         other.half_z * std::abs(other.axis_z.dot(axis));
    if (std::abs(between.dot(axis)) > reach) return false;
  }
  return true;
}

Footprint footprint_of(const GroundPose& pose, double half_x, double half_z) {
  const Eigen::Vector2d forward(std::sin(pose.heading), std::cos(pose.heading));
  return {pose.position, {forward.y(), -forward.x()}, forward, half_x, half_z};
}

}  // namespace penumbra::slam::synthetic
