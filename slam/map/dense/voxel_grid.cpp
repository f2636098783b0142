#include "slam/map/dense/voxel_grid.h"

#include <cmath>
#include <limits>

#include "nn/base/counter_random.h"
#include "nn/base/error.h"

namespace penumbra::slam {

namespace {

constexpr std::size_t kFirstSlots = 1 << 12;
constexpr std::uint64_t kNowhere = ~std::uint64_t{0};
constexpr float kFarthestVoxel = 1e6F;  // in voxels, along an axis: 21 bits hold it

}  // namespace

VoxelGrid::VoxelGrid(double size)
    : size_(size), inverse_size_(static_cast<float>(1.0 / size)), table_(kFirstSlots, kFree) {
  if (!(size > 0.0) || !std::isfinite(size)) {
    throw UsageError(fmt::format("voxels: expected a size above 0 metres, found {}", size));
  }
}

std::uint64_t VoxelGrid::key_of(const Eigen::Vector3f& place) const {
  std::uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float cell = std::floor(place[axis] * inverse_size_);
    if (!(std::abs(cell) < kFarthestVoxel)) return kNowhere;
    key = key << 21 | static_cast<std::uint64_t>(static_cast<std::int64_t>(cell) + (1 << 20));
  }
  return key;
}

std::size_t VoxelGrid::slot_of(std::uint64_t key) const {
  const std::size_t mask = table_.size() - 1;
  std::size_t slot = counter_random(0, key) & mask;
  while (table_[slot] != kFree && keys_[table_[slot]] != key) slot = (slot + 1) & mask;
  return slot;
}

void VoxelGrid::rebuild(std::size_t slots) {
  table_.assign(slots, kFree);
  for (std::size_t i = 0; i < voxels_.size(); ++i) table_[slot_of(keys_[i])] = static_cast<std::uint32_t>(i);
}

void VoxelGrid::add(const SurfaceSample& point, std::uint32_t view) {
  const std::uint64_t key = key_of(point.place);
  if (key == kNowhere) return;
  std::size_t slot = slot_of(key);
  if (table_[slot] == kFree) {
    if (2 * (voxels_.size() + 1) > table_.size()) {
      rebuild(2 * table_.size());
      slot = slot_of(key);
    }
    table_[slot] = static_cast<std::uint32_t>(voxels_.size());
    keys_.push_back(key);
    voxels_.push_back({.place = point.place,
                       .weight = point.weight,
                       .colour = point.colour,
                       .class_id = point.class_id,
                       .lead = 1,
                       .last_view = view,
                       .views = 1});
    return;
  }
  Voxel& voxel = voxels_[table_[slot]];
  voxel.weight += point.weight;
  const float share = point.weight / voxel.weight;
  voxel.place += share * (point.place - voxel.place);
  voxel.colour += share * (point.colour - voxel.colour);
  // Boyer and Moore's majority vote: a class that more than half of the measurements have is found.
  constexpr std::uint16_t kMost = std::numeric_limits<std::uint16_t>::max();
  if (voxel.class_id == point.class_id) {
    if (voxel.lead < kMost) ++voxel.lead;
  } else if (voxel.lead > 0) {
    --voxel.lead;
  } else {
    voxel.class_id = point.class_id;
    voxel.lead = 1;
  }
  if (voxel.last_view != view) {
    voxel.last_view = view;
    if (voxel.views < kMost) ++voxel.views;
  }
}

const Voxel* VoxelGrid::find(const Eigen::Vector3f& place) const {
  const std::uint64_t key = key_of(place);
  if (key == kNowhere) return nullptr;
  const std::uint32_t found = table_[slot_of(key)];
  return found == kFree ? nullptr : &voxels_[found];
}

std::size_t VoxelGrid::bytes() const {
  return voxels_.capacity() * sizeof(Voxel) + keys_.capacity() * sizeof(std::uint64_t) +
         table_.capacity() * sizeof(std::uint32_t);
}

}  // namespace penumbra::slam
