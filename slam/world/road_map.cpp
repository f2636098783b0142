#include "slam/world/road_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slam/world/noise.h"

namespace penumbra::slam::synthetic {

namespace {

constexpr double kSegmentLength = 2.0;
// Two roads that are both this near (metres) but not neighbours along one road make a junction.
constexpr float kJunctionDistance = 8.0F, kJunctionAlong = 40.0F;

float squared_distance(const Eigen::Vector2f& from, const Eigen::Vector2f& direction, float length,
                       const Eigen::Vector2f& p) {
  const float t = std::clamp((p - from).dot(direction), 0.0F, length);
  return (p - from - t * direction).squaredNorm();
}

}  // namespace

RoadMap::RoadMap(const std::vector<Route>& roads) {
  Eigen::Vector2f lower = Eigen::Vector2f::Constant(std::numeric_limits<float>::max()), upper = -lower;
  for (std::size_t r = 0; r < roads.size(); ++r) {
    const Route& road = roads[r];
    const int pieces = std::max(1, static_cast<int>(road.length() / kSegmentLength));
    for (int i = 0; i < pieces; ++i) {
      const double from = road.length() * i / pieces, to = road.length() * (i + 1) / pieces;
      // The very end of a closed route would wrap to its start, which is the same point.
      const Eigen::Vector2f a = road.at(from).position.cast<float>(), b = road.at(to).position.cast<float>();
      const float length = (b - a).norm();
      if (length <= 0.0F) continue;
      segments_.push_back({a, (b - a) / length, length, static_cast<float>(from), static_cast<int>(r)});
      lower = lower.cwiseMin(a.cwiseMin(b));
      upper = upper.cwiseMax(a.cwiseMax(b));
    }
  }
  if (segments_.empty()) return;
  constexpr float kBlockSize = kCell * kBlock;
  first_block_x_ = floor_int((lower.x() - kReach) / kBlockSize) - 1;
  first_block_z_ = floor_int((lower.y() - kReach) / kBlockSize) - 1;
  blocks_x_ = floor_int((upper.x() + kReach) / kBlockSize) + 2 - first_block_x_;
  blocks_z_ = floor_int((upper.y() + kReach) / kBlockSize) + 2 - first_block_z_;
  blocks_.assign(static_cast<std::size_t>(blocks_x_) * static_cast<std::size_t>(blocks_z_), -1);

  // Every cell first collects all segments within reach, then keeps those that can be nearest in it.
  const float half_diagonal = kCell * std::sqrt(0.5F);
  std::vector<std::vector<std::int32_t>> near;
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    const Segment& segment = segments_[s];
    const Eigen::Vector2f to = segment.from + segment.length * segment.direction;
    const float reach = kReach + half_diagonal;
    const Eigen::Vector2f low = segment.from.cwiseMin(to).array() - reach;
    const Eigen::Vector2f high = segment.from.cwiseMax(to).array() + reach;
    for (int cz = floor_int(low.y() / kCell); cz <= floor_int(high.y() / kCell); ++cz) {
      for (int cx = floor_int(low.x() / kCell); cx <= floor_int(high.x() / kCell); ++cx) {
        const Eigen::Vector2f centre((static_cast<float>(cx) + 0.5F) * kCell,
                                     (static_cast<float>(cz) + 0.5F) * kCell);
        if (squared_distance(segment.from, segment.direction, segment.length, centre) > reach * reach)
          continue;
        const int bx = floor_int(static_cast<float>(cx) / kBlock),
                  bz = floor_int(static_cast<float>(cz) / kBlock);
        std::int32_t& block =
            blocks_[static_cast<std::size_t>((bz - first_block_z_) * blocks_x_ + bx - first_block_x_)];
        if (block < 0) {
          block = static_cast<std::int32_t>(near.size());
          near.resize(near.size() + kBlock * kBlock);
        }
        near[static_cast<std::size_t>(block + (cz - bz * kBlock) * kBlock + cx - bx * kBlock)].push_back(
            static_cast<std::int32_t>(s));
      }
    }
  }
  cells_.resize(near.size());
  for (int bz = 0; bz < blocks_z_; ++bz) {
    for (int bx = 0; bx < blocks_x_; ++bx) {
      const std::int32_t block = blocks_[static_cast<std::size_t>(bz * blocks_x_ + bx)];
      if (block < 0) continue;
      for (int i = 0; i < kBlock * kBlock; ++i) {
        Cell& cell = cells_[static_cast<std::size_t>(block + i)];
        const auto& candidates = near[static_cast<std::size_t>(block + i)];
        const Eigen::Vector2f centre(
            (static_cast<float>((bx + first_block_x_) * kBlock + i % kBlock) + 0.5F) * kCell,
            (static_cast<float>((bz + first_block_z_) * kBlock + i / kBlock) + 0.5F) * kCell);
        std::vector<float> distances;
        std::size_t best = 0;
        for (const std::int32_t s : candidates) {
          const Segment& segment = segments_[static_cast<std::size_t>(s)];
          distances.push_back(
              std::sqrt(squared_distance(segment.from, segment.direction, segment.length, centre)));
          if (distances.back() < distances[best]) best = distances.size() - 1;
        }
        cell.first = static_cast<std::int32_t>(candidates_.size());
        for (std::size_t k = 0; k < candidates.size(); ++k) {
          if (distances[k] <= distances[best] + 2.0F * half_diagonal) {
            candidates_.push_back(candidates[k]);
            ++cell.count;
          }
          const Segment& here = segments_[static_cast<std::size_t>(candidates[best])];
          const Segment& other = segments_[static_cast<std::size_t>(candidates[k])];
          const float road_length = static_cast<float>(roads[static_cast<std::size_t>(here.road)].length());
          float apart = std::abs(here.along - other.along);
          if (roads[static_cast<std::size_t>(here.road)].closed())
            apart = std::min(apart, road_length - apart);
          if (distances[k] < kJunctionDistance && (here.road != other.road || apart > kJunctionAlong)) {
            cell.junction = true;
          }
        }
      }
    }
  }
}

int RoadMap::cell_index(int cell_x, int cell_z) const {
  const int block_x = (cell_x >= 0 ? cell_x : cell_x - kBlock + 1) / kBlock;
  const int block_z = (cell_z >= 0 ? cell_z : cell_z - kBlock + 1) / kBlock;
  const int x = block_x - first_block_x_, z = block_z - first_block_z_;
  if (x < 0 || z < 0 || x >= blocks_x_ || z >= blocks_z_) return -1;
  const std::int32_t block = blocks_[static_cast<std::size_t>(z * blocks_x_ + x)];
  if (block < 0) return -1;
  return block + (cell_z - block_z * kBlock) * kBlock + cell_x - block_x * kBlock;
}

RoadPoint RoadMap::at(float x, float z) const {
  RoadPoint point;
  const float cell_x = x / kCell, cell_z = z / kCell;
  if (std::abs(cell_x) > 1e8F || std::abs(cell_z) > 1e8F) return point;
  const int index = cell_index(floor_int(cell_x), floor_int(cell_z));
  if (index < 0) return point;
  const Cell& cell = cells_[static_cast<std::size_t>(index)];
  float best = 1e12F;
  for (int k = 0; k < cell.count; ++k) {
    const Segment& segment =
        segments_[static_cast<std::size_t>(candidates_[static_cast<std::size_t>(cell.first + k)])];
    const float dx = x - segment.from.x(), dz = z - segment.from.y();
    const float t = dx * segment.direction.x() + dz * segment.direction.y();
    const float inside = std::min(std::max(t, 0.0F), segment.length);
    const float ex = dx - inside * segment.direction.x(), ez = dz - inside * segment.direction.y();
    const float squared = ex * ex + ez * ez;
    if (squared < best) {
      best = squared;
      point.along = segment.along + inside;
      point.lateral = dx * segment.direction.y() - dz * segment.direction.x();
    }
  }
  if (cell.count == 0) return point;
  point.distance = std::sqrt(best);
  point.lateral = std::copysign(point.distance, point.lateral);
  point.junction = cell.junction;
  return point;
}

}  // namespace penumbra::slam::synthetic
