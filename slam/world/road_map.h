// Where a point of the ground lies relative to the roads: across, along and how far away.
//
// Roads are centrelines cut into short straight segments. Cells of 2 m hold the few segments that can be the
// nearest one for a point inside, so a look-up costs about four point-to-segment distances wherever the road
// goes; cells live in blocks of 64 m that exist only near roads.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "slam/world/route.h"

namespace penumbra::slam::synthetic {

struct RoadPoint {
  float distance = 1e6F;  // metres to the nearest centreline; 1e6 beyond RoadMap::kReach
  float lateral = 1e6F;   // the same with a sign: positive to the right
  float along = 0.0F;     // metres along that road
  bool junction = false;  // another road, or another part of this one, crosses here
};

class RoadMap {
 public:
  static constexpr float kReach = 18.0F;  // metres from a centreline that are covered at least

  RoadMap() = default;
  explicit RoadMap(const std::vector<Route>& roads);

  RoadPoint at(float x, float z) const;

 private:
  struct Segment {
    Eigen::Vector2f from, direction;  // direction has unit length
    float length = 0.0F, along = 0.0F;
    int road = 0;
  };
  struct Cell {
    std::int32_t first = 0;  // in candidates_
    std::int16_t count = 0;
    bool junction = false;
  };
  static constexpr float kCell = 2.0F;
  static constexpr int kBlock = 32;  // cells along a block's side

  int cell_index(int cell_x, int cell_z) const;  // -1 where no road is near

  std::vector<Segment> segments_;
  std::vector<std::int32_t> candidates_;  // segment numbers, grouped by cell
  std::vector<std::int32_t> blocks_;      // first cell of each block, -1 where it has none
  std::vector<Cell> cells_;
  int first_block_x_ = 0, first_block_z_ = 0, blocks_x_ = 0, blocks_z_ = 0;
};

}  // namespace penumbra::slam::synthetic
