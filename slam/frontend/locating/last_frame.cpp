#include "slam/frontend/locating/last_frame.h"

#include <algorithm>
#include <cmath>

#include "slam/frontend/features/descriptor_matcher.h"
#include "slam/frontend/features/level_of_size.h"
#include "slam/frontend/features/measurement.h"

namespace penumbra::slam {

void LastFrame::remember(Frame& frame) {
  frame.patches = std::make_shared<const std::vector<Patch>>(extract_patches(*frame.pyramid, frame.view()));
  frame_ = frame;
  keyframe_ = nullptr;
}

void LastFrame::set_keyframe(KeyFrame* keyframe) {
  keyframe_ = keyframe;
  frame_.reference = keyframe;
  frame_.T_c_reference = SE3{};
}

void LastFrame::set_movable(int index, const std::vector<char>& movable) {
  if (!empty() && frame_.index == index && movable.size() == frame_.points.size()) frame_.movable = movable;
}

void LastFrame::refresh() {
  if (frame_.reference != nullptr) frame_.T_cw = frame_.T_c_reference * current_pose(*frame_.reference);
  if (keyframe_ != nullptr && !keyframe_->erased) {
    frame_.points = keyframe_->points;
    frame_.movable = keyframe_->movable;
  }
  for (MapPoint*& point : frame_.points) point = present(point);
}

std::optional<Eigen::Vector3d> LastFrame::point(int feature) const {
  const FeatureView features = frame_.view();
  if (features.is_movable(feature)) return std::nullopt;
  if (const MapPoint* point = map_point(feature)) return point->position;
  if (!features.has_stereo(feature)) return std::nullopt;
  const FeaturePixel pixel = features.pixel(feature);
  return frame_.T_cw.inverse() * map_.camera().back_project(pixel.u, pixel.v, features.depth(feature));
}

LoosePoint LastFrame::loose_point(int feature, int last_feature) const {
  const auto at = static_cast<std::size_t>(last_feature);
  return {feature, *point(last_feature), &(*frame_.patches)[at], frame_.features->depth[at]};
}

std::vector<Projection> LastFrame::project(const SE3& T_cw) const {
  const FrameFeatures& features = *frame_.features;
  const int highest = static_cast<int>(map_.scales().size()) - 1;
  const double step = level_step(map_.scales());
  std::vector<Projection> projections;
  projections.reserve(static_cast<std::size_t>(features.size()));
  for (int i = 0; i < features.size(); ++i) {
    const std::optional<Eigen::Vector3d> point = this->point(i);
    if (!point) continue;
    const Eigen::Vector3d p = T_cw * *point;
    if (!(p.z() > 0.0)) continue;
    const Keypoint& k = features.keypoint(i);
    const Eigen::Vector3d pixel = map_.camera().project_stereo(p);
    if (!map_.camera().in_image(pixel.head<2>())) continue;
    const double nearer = (frame_.T_cw * *point).norm() / p.norm();
    const int level =
        std::clamp(k.level + static_cast<int>(std::lround(level_of_size(nearer, step))), 0, highest);
    projections.push_back({static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                           static_cast<float>(pixel.z()), level, k.angle, &features.descriptor(i), i});
  }
  return projections;
}

std::vector<MatchedPixels> LastFrame::pixels(const std::vector<Match>& matches,
                                             const std::vector<Projection>& projections,
                                             const FeatureView& features) const {
  std::vector<Eigen::Vector2f> expected(frame_.points.size());
  for (const Projection& p : projections) expected[static_cast<std::size_t>(p.source)] = {p.u, p.v};
  std::vector<MatchedPixels> pixels;
  pixels.reserve(matches.size());
  for (const Match& match : matches) {
    const FeaturePixel a = frame_.view().pixel(match.source), b = features.pixel(match.feature);
    pixels.push_back({{a.u, a.v}, {b.u, b.v}, expected[static_cast<std::size_t>(match.source)]});
  }
  return pixels;
}

std::vector<PoseObservation> LastFrame::match_anywhere(const FeatureView& features) const {
  std::vector<PoseObservation> observations;
  for (const Match& match :
       match_descriptors(frame_.features->left.descriptors, features.measured().left.descriptors, {})) {
    const std::optional<Eigen::Vector3d> point = this->point(match.source);
    if (!point || features.is_movable(match.feature)) continue;
    observations.push_back({*point, measurement_of(features, match.feature, map_.scales())});
  }
  return observations;
}

}  // namespace penumbra::slam
