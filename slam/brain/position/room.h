// The rooms in which grid cells are trained and measured: a square, a regular hexagon and an L, all in
// [-1.15, 1.15] metres.
//
//   inside       a ray to the right crosses the outline an odd number of times
//   wall ahead   d = least t > 0 at which x + t (cos h, sin h) lies on a wall      (|X_w - X_p| of D.1)
//
// Cost: a few operations a wall.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>
#include <vector>

namespace penumbra::slam::brain {

enum class RoomShape { square, hexagon, l_shape };

// "square", "hexagon", "L"; UsageError for another name.
RoomShape parse_room(std::string_view name);
const char* to_string(RoomShape shape);

class Room {
 public:
  explicit Room(RoomShape shape);

  RoomShape shape() const { return shape_; }
  // In order; the last wall leads back to the first corner.
  std::span<const Eigen::Vector2d> corners() const { return corners_; }
  bool contains(const Eigen::Vector2d& position) const;
  // Metres; `heading` in radians from x to y. 9 where there is no wall ahead.
  double wall_ahead(const Eigen::Vector2d& position, double heading) const;
  // Where a walk begins: a point well inside.
  Eigen::Vector2d start() const;

 private:
  RoomShape shape_;
  std::vector<Eigen::Vector2d> corners_;
};

}  // namespace penumbra::slam::brain
