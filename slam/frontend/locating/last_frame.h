// The last frame that was located, and where its features are in space.
//
// A feature's place is known from the map, where it shows a map point, else from its own stereo depth. The
// map changes between two frames: refresh() moves the frame along with its keyframe and takes over the points
// that the mapper has made, merged or removed.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "slam/frontend/features/frame_matcher.h"
#include "slam/frontend/features/mismatch_filter.h"
#include "slam/frontend/locating/frame.h"
#include "slam/geometry/pose_optimizer.h"
#include "slam/map/map.h"

namespace penumbra::slam {

class LastFrame {
 public:
  explicit LastFrame(const Map& map) : map_(map) {}

  bool empty() const { return frame_.features == nullptr; }
  const SE3& T_cw() const { return frame_.T_cw; }
  double timestamp() const { return frame_.timestamp; }  // seconds

  int index() const { return frame_.index; }

  // Takes `frame`, which must have its pyramid, as the last one; gives it its patches.
  void remember(Frame& frame);
  // More of it is known to move by now: per feature of frame `index`, if that is the last one.
  void set_movable(int index, const std::vector<char>& movable);
  // It has become `keyframe`, which is in the map when the next frame comes.
  void set_keyframe(KeyFrame* keyframe);
  void refresh();
  // There is none.
  void forget() {
    frame_ = {};
    keyframe_ = nullptr;
  }

  // World; nothing where neither the map nor stereo knows, and on what moves.
  std::optional<Eigen::Vector3d> point(int feature) const;
  // The map point that the feature shows, or nullptr.
  MapPoint* map_point(int feature) const { return frame_.points[static_cast<std::size_t>(feature)]; }
  // The feature's place, patch and depth, for which there must be a point().
  LoosePoint loose_point(int feature, int last_feature) const;

  // Every point as a camera at `T_cw` sees it, on the level on which its size by now puts it.
  std::vector<Projection> project(const SE3& T_cw) const;
  // The pixels of each match of `projections` with the features of another frame, and the one where it was
  // looked for.
  std::vector<MatchedPixels> pixels(const std::vector<Match>& matches,
                                    const std::vector<Projection>& projections,
                                    const FeatureView& features) const;
  // What the features of another frame measure of the points whose descriptors they resemble, wherever they
  // are in the image: about a third of the pairs are wrong.
  std::vector<PoseObservation> match_anywhere(const FeatureView& features) const;

 private:
  const Map& map_;
  Frame frame_;
  KeyFrame* keyframe_ = nullptr;  // what the frame has become, if it has
};

}  // namespace penumbra::slam
