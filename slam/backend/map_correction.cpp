#include "slam/backend/map_correction.h"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "slam/backend/point_fusion.h"

namespace penumbra::slam {

namespace {

using Pair = std::pair<int, int>;  // ids of keyframes, the smaller first

Pair pair_of(const KeyFrame& a, const KeyFrame& b) { return {std::min(a.id, b.id), std::max(a.id, b.id)}; }

class Correction {
 public:
  Correction(Map& map, KeyFrame* keyframe, const VerifiedPlace& place, const MapCorrectionSettings& settings)
      : map_(map), keyframe_(keyframe), place_(place), settings_(settings) {
    T_cw_ = place.T_cw;
    depth_ = typical_depth(*keyframe);
  }

  MapCorrection run(const std::vector<LoopEdge>& earlier_loops) {
    MapCorrection result;
    result.merged_submaps = keyframe_->submap != place_.keyframe->submap;
    if (result.merged_submaps) merge_submaps();
    add_edges_before(earlier_loops);
    move_neighbourhood();
    result.fused = fuse();
    if (!result.merged_submaps) {
      add_edges_after();
      result.pose_graph = solve_pose_graph(graph_, settings_.pose_graph);
      apply();
    }
    for (const auto& point : map_.points()) {
      if (!point->erased) map_.update_point(point.get());
    }
    return result;
  }

 private:
  // Median depth of the points that a keyframe sees, metres.
  static double typical_depth(const KeyFrame& keyframe) {
    std::vector<double> depths;
    for (const MapPoint* point : keyframe.points) {
      if (point != nullptr) depths.push_back((keyframe.T_cw * point->position).norm());
    }
    if (depths.empty()) return 1.0;
    const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::nth_element(depths.begin(), middle, depths.end());
    return *middle;
  }

  // The younger of the two sub-maps moves onto the older one and becomes part of it.
  void merge_submaps() {
    const int into = std::min(keyframe_->submap, place_.keyframe->submap);
    const int from = std::max(keyframe_->submap, place_.keyframe->submap);
    // Takes the keyframe's world to the place's.
    SE3 S = place_.T_cw.inverse() * keyframe_->T_cw;
    if (keyframe_->submap == into) {
      S = S.inverse();
      T_cw_ = keyframe_->T_cw;
    }
    const SE3 S_inverse = S.inverse();
    for (const auto& point : map_.points()) {
      if (point->erased || point->observations.empty()) continue;
      if (point->observations.front().keyframe->submap == from) point->position = S * point->position;
    }
    for (KeyFrame* k : map_.keyframes()) {
      if (k->submap != from) continue;
      k->T_cw = k->T_cw * S_inverse;
      k->T_cw.normalize();
      k->submap = into;
    }
  }

  Matrix6d information(int shared_points) const {
    Vector6d diagonal;
    diagonal << Eigen::Vector3d::Ones(), Eigen::Vector3d::Constant(depth_ * depth_);
    return Matrix6d((static_cast<double>(shared_points) * diagonal).asDiagonal());
  }

  void add_edge(const KeyFrame& a, const KeyFrame& b, const SE3& T_ab, int shared) {
    if (!linked_.insert(pair_of(a, b)).second) return;
    graph_.edges.push_back({node_.at(&a), node_.at(&b), T_ab, information(std::max(shared, 1))});
  }

  // Odometry: every keyframe with the older one it shares the most points with (the spanning tree), and with
  // all that it shares many with.
  void add_edges_before(const std::vector<LoopEdge>& earlier_loops) {
    for (KeyFrame* k : map_.keyframes()) {
      if (k->submap != keyframe_->submap) continue;
      node_[k] = static_cast<int>(graph_.poses.size());
      graph_.poses.push_back(k->T_cw);
      graph_.fixed.push_back(keyframes_.empty());
      keyframes_.push_back(k);
    }
    for (std::size_t n = 0; n < keyframes_.size(); ++n) {
      const KeyFrame& k = *keyframes_[n];
      bool has_parent = n == 0;
      for (const Covisible& c : k.covisibles) {
        neighbours_before_.insert(pair_of(k, *c.keyframe));
        const bool older = c.keyframe->id < k.id;
        if (older && (!has_parent || c.shared_points >= settings_.strong_edge)) {
          has_parent = true;
          add_edge(k, *c.keyframe, k.T_cw * c.keyframe->T_cw.inverse(), c.shared_points);
        }
      }
      // Tied to nothing older (tracking was thin there): it follows the keyframe before it.
      if (!has_parent) add_edge(k, *keyframes_[n - 1], k.T_cw * keyframes_[n - 1]->T_cw.inverse(), 1);
    }
    for (const LoopEdge& loop : earlier_loops) {
      if (loop.a->erased || loop.b->erased || loop.a->submap != keyframe_->submap) continue;
      add_edge(*loop.a, *loop.b, loop.a->T_cw * loop.b->T_cw.inverse(), loop.inliers);
    }
  }

  // The keyframe, its neighbours and what they see, as one rigid piece.
  void move_neighbourhood() {
    const SE3 T_before = keyframe_->T_cw;
    const SE3 S = T_cw_.inverse() * T_before;
    group_ = {keyframe_};
    for (const Covisible& c : keyframe_->covisibles) group_.push_back(c.keyframe);
    for (KeyFrame* k : group_) {
      k->T_cw = k->T_cw * S.inverse();
      k->T_cw.normalize();
      for (MapPoint* point : k->points) {
        if (point != nullptr && moved_.insert(point).second) point->position = S * point->position;
      }
    }
  }

  int fuse() {
    int fused = 0;
    for (std::size_t i = 0; i < place_.points.size(); ++i) {
      MapPoint* old_point = place_.points[i];
      if (old_point == nullptr || old_point->erased) continue;
      MapPoint* own = keyframe_->points[i];
      if (own == nullptr) {
        map_.add_observation(old_point, keyframe_, static_cast<int>(i));
      } else {
        map_.merge_points(own, old_point);
      }
      ++fused;
    }
    const std::vector<MapPoint*> around = points_around(*place_.keyframe, settings_.neighbours);
    for (KeyFrame* k : group_) fused += fuse_points(map_, k, around, settings_.fusion_radius, true);
    for (KeyFrame* k : group_) map_.update_covisibility(k);
    return fused;
  }

  // Loop edges: the covisibility that fusing has made, with the poses as the loop has them.
  void add_edges_after() {
    add_edge_always(*keyframe_, *place_.keyframe, place_.inliers);
    const std::unordered_set<const KeyFrame*> in_group(group_.begin(), group_.end());
    for (const KeyFrame* k : group_) {
      for (const Covisible& c : k->covisibles) {
        if (in_group.count(c.keyframe) > 0 || neighbours_before_.count(pair_of(*k, *c.keyframe)) > 0)
          continue;
        if (node_.count(c.keyframe) == 0) continue;
        add_edge(*k, *c.keyframe, k->T_cw * c.keyframe->T_cw.inverse(), c.shared_points);
      }
    }
  }

  void add_edge_always(const KeyFrame& a, const KeyFrame& b, int shared) {
    linked_.erase(pair_of(a, b));
    add_edge(a, b, a.T_cw * b.T_cw.inverse(), shared);
  }

  // Every point moves with a keyframe that sees it; what the loop has moved already, with the loop's
  // keyframe.
  void apply() {
    const SE3 T_wc_loop = graph_.poses[static_cast<std::size_t>(node_.at(keyframe_))].inverse();
    for (const auto& point : map_.points()) {
      if (point->erased || point->observations.empty()) continue;
      if (moved_.count(point.get()) > 0) {
        point->position = T_wc_loop * (keyframe_->T_cw * point->position);
        continue;
      }
      KeyFrame* seen_by = point->observations.front().keyframe;
      const auto at = node_.find(seen_by);
      if (at == node_.end()) continue;
      const SE3& T_new = graph_.poses[static_cast<std::size_t>(at->second)];
      point->position = T_new.inverse() * (seen_by->T_cw * point->position);
    }
    for (std::size_t n = 0; n < keyframes_.size(); ++n) keyframes_[n]->T_cw = graph_.poses[n];
  }

  Map& map_;
  KeyFrame* keyframe_;
  const VerifiedPlace& place_;
  const MapCorrectionSettings& settings_;
  SE3 T_cw_;  // of the keyframe, where the loop has it
  double depth_ = 1.0;
  PoseGraph graph_;
  std::vector<KeyFrame*> keyframes_;  // of the graph's poses
  std::unordered_map<const KeyFrame*, int> node_;
  std::set<Pair> linked_, neighbours_before_;
  std::vector<KeyFrame*> group_;
  std::unordered_set<const MapPoint*> moved_;
};

}  // namespace

MapCorrection correct_map(Map& map, KeyFrame* keyframe, const VerifiedPlace& place,
                          const std::vector<LoopEdge>& earlier_loops, const MapCorrectionSettings& settings) {
  return Correction(map, keyframe, place, settings).run(earlier_loops);
}

}  // namespace penumbra::slam
