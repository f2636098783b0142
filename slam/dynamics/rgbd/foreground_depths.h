// Which depths in a person's box are the person's, from those of the feature points (adaptive DBSCAN).
//
// Mode `paper`, the default (Xu et al., "clusters of depth; eps and minPts adapt to the data", which leaves
// open how): minPts = ln n, eps at the knee of the sorted distances to the minPts-th nearest depth; the
// cluster with the lowest mean depth is the person, all else is background. Mode `adaptive`, which leaves
// less of people (docs/dynamics/static-points.md):
//
//   on log z, for depth noise and the spread of a body's features grow with z
//   minPts = sqrt n, eps = 0.06: 6 % of the depth
//   the person is the cluster with the largest   share of the box's depths - share of its ring's depths
//
// The ring is a frame around the box: a desk, a floor or a wall goes on there, the person does not. Cost: O(n
// log n), 20 us for 400 features.
// Source: Xu, Chen, Liu, Han, VSLAM algorithm based on attention mechanism and geometric constraints in
// dynamic scenes (Chinese Journal of Sensors and Actuators, 2023).
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace penumbra::slam {

enum class ForegroundMode { paper, adaptive };

struct ForegroundSettings {
  ForegroundMode mode = ForegroundMode::paper;
  double eps = 0.06;        // of the depth; of `adaptive`
  double ring_share = 0.3;  // of the box's sides
  int fewest = 8;           // depths in the box, below which they say nothing
};

// Depths in metres, ends included.
struct DepthRange {
  float nearest = 0.0F, farthest = 0.0F;
  bool contains(float depth) const { return depth >= nearest && depth <= farthest; }
};

// Keeps its memory from box to box; for one thread at a time.
class ForegroundDepths {
 public:
  explicit ForegroundDepths(const ForegroundSettings& settings) : settings_(settings) {}

  // `in_box`, `in_ring`: depths of features, metres, above 0, in any order; both are sorted. Nothing where
  // they are too few, or no cluster stands out from the ring.
  std::optional<DepthRange> find(std::vector<float>& in_box, std::vector<float>& in_ring);

 private:
  std::optional<DepthRange> find_as_paper(std::span<const float> in_box);
  std::optional<DepthRange> find_adaptive(std::span<const float> in_box, std::span<const float> in_ring);

  const ForegroundSettings settings_;
  std::vector<int> cluster_;
  std::vector<float> distance_, logs_;
};

}  // namespace penumbra::slam
