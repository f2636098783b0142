#include "slam/brain/position/room.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "nn/base/error.h"

namespace penumbra::slam::brain {

namespace {

constexpr double kHexagonRadius = 1.15;  // metres: an area of 3.4 m^2, the square has 4
constexpr double kFarAway = 9.0;         // metres, beyond every wall

std::vector<Eigen::Vector2d> corners_of(RoomShape shape) {
  if (shape == RoomShape::square) return {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  if (shape == RoomShape::l_shape) return {{-1, -1}, {1, -1}, {1, 0}, {0, 0}, {0, 1}, {-1, 1}};
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i < 6; ++i) {
    const double angle = i * std::numbers::pi / 3.0;
    corners.emplace_back(kHexagonRadius * std::cos(angle), kHexagonRadius * std::sin(angle));
  }
  return corners;
}

}  // namespace

RoomShape parse_room(std::string_view name) {
  for (const RoomShape shape : {RoomShape::square, RoomShape::hexagon, RoomShape::l_shape}) {
    if (name == to_string(shape)) return shape;
  }
  throw UsageError(fmt::format("room: expected square, hexagon or L, found '{}'", name));
}

const char* to_string(RoomShape shape) {
  switch (shape) {
    case RoomShape::square:
      return "square";
    case RoomShape::hexagon:
      return "hexagon";
    case RoomShape::l_shape:
      return "L";
  }
  return "";
}

Room::Room(RoomShape shape) : shape_(shape), corners_(corners_of(shape)) {}

bool Room::contains(const Eigen::Vector2d& position) const {
  bool inside = false;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Eigen::Vector2d &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
    if ((a.y() > position.y()) == (b.y() > position.y())) continue;
    const double crossing = a.x() + (b.x() - a.x()) * (position.y() - a.y()) / (b.y() - a.y());
    if (position.x() < crossing) inside = !inside;
  }
  return inside;
}

double Room::wall_ahead(const Eigen::Vector2d& position, double heading) const {
  const Eigen::Vector2d ahead(std::cos(heading), std::sin(heading));
  double nearest = kFarAway;
  for (std::size_t i = 0; i < corners_.size(); ++i) {
    const Eigen::Vector2d to_wall = corners_[i] - position;
    const Eigen::Vector2d wall = corners_[(i + 1) % corners_.size()] - corners_[i];
    const double sine = wall.x() * ahead.y() - wall.y() * ahead.x();
    if (std::abs(sine) < 1e-9) continue;  // along the wall
    const double distance = (wall.x() * to_wall.y() - wall.y() * to_wall.x()) / sine;
    const double along = (ahead.x() * to_wall.y() - ahead.y() * to_wall.x()) / sine;
    if (distance > 0.0 && along >= 0.0 && along <= 1.0) nearest = std::min(nearest, distance);
  }
  return nearest;
}

Eigen::Vector2d Room::start() const {
  return shape_ == RoomShape::l_shape ? Eigen::Vector2d(-0.5, -0.5) : Eigen::Vector2d::Zero();
}

}  // namespace penumbra::slam::brain
