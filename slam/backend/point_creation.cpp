#include "slam/backend/point_creation.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "slam/frontend/features/measurement.h"
#include "slam/frontend/features/nearest_descriptor.h"
#include "slam/geometry/triangulation.h"

namespace penumbra::slam {

namespace {

constexpr int kMaxHamming = 50;
constexpr float kRatio = 0.8F;
constexpr double kCosLeastParallax = 0.9998;  // 1.15 degrees
constexpr double kLongestSearch = 120.0;      // pixels along the epipolar line

bool is_free(const KeyFrame& keyframe, int i) {
  return keyframe.points[static_cast<std::size_t>(i)] == nullptr && !keyframe.view().is_movable(i);
}

Eigen::Vector2d pixel_of(const KeyFrame& keyframe, int i) {
  const FeaturePixel pixel = keyframe.view().pixel(i);
  return {pixel.u, pixel.v};
}

// Searches pairs of one keyframe and one neighbour.
class PairSearch {
 public:
  PairSearch(const StereoCamera& camera, const KeyFrame& first, const KeyFrame& second,
             const std::vector<double>& scales, double nearest_depth)
      : camera_(camera),
        first_(first),
        second_(second),
        scales_(scales),
        nearest_depth_(nearest_depth),
        T_21_(second.T_cw * first.T_cw.inverse()),
        F_(fundamental_matrix(camera, first.T_cw, second.T_cw)) {
    for (int j = 0; j < second.features->size(); ++j) is_free_.push_back(is_free(second, j));
  }

  // The feature of the second keyframe that looks like feature `i` of the first; -1 where none does.
  int partner(int i) const {
    const Eigen::Vector2d pixel = pixel_of(first_, i);
    const Eigen::Vector3d ray = camera_.back_project(pixel.x(), pixel.y(), 1.0);
    // From the vanishing point, where a point at infinity would be seen, to that of the nearest depth.
    const Eigen::Vector3d far = T_21_.rotation * ray;
    const Eigen::Vector3d near = T_21_ * (ray * nearest_depth_);
    if (far.z() <= 0.1) return -1;
    const Eigen::Vector2d from = camera_.project(far);
    Eigen::Vector2d to = near.z() > 0.1 ? camera_.project(near) : from;
    const double length = (to - from).norm();
    if (length > kLongestSearch) to = from + (to - from) * (kLongestSearch / length);

    const int level = first_.features->keypoint(i).level;
    const double margin = 3.0 * scales_[static_cast<std::size_t>(level)];
    const Eigen::Vector2d centre = 0.5 * (from + to);
    const float radius = static_cast<float>(0.5 * (to - from).lpNorm<Eigen::Infinity>() + margin);
    const EpipolarLine line(F_, pixel);
    const Descriptor& looks = first_.features->descriptor(i);
    NearestDescriptor nearest = NearestDescriptor::within(kMaxHamming + 1);
    // Features lie off the line by their deviation, and off their cells by what their patches moved them.
    const float off_line = static_cast<float>(8.0 * scales_[static_cast<std::size_t>(level)]);
    const Eigen::Vector3f abc = line.coefficients().cast<float>();
    second_.features->grid.visit_near_line(
        static_cast<float>(centre.x()), static_cast<float>(centre.y()), radius, {abc.x(), abc.y(), abc.z()},
        off_line, [&](int j, int other_level) {
          if (std::abs(other_level - level) > 1 || !is_free_[static_cast<std::size_t>(j)]) return;
          const int distance = hamming_distance(looks, second_.features->descriptor(j));
          if (distance >= nearest.second_distance) return;  // it would change nothing
          const double sigma = scales_[static_cast<std::size_t>(other_level)];
          if (line.squared_distance(pixel_of(second_, j)) > kChiSquare1 * sigma * sigma) return;
          nearest.offer(j, distance);
        });
    return nearest.index >= 0 && nearest.is_ambiguous(kRatio) ? -1 : nearest.index;
  }

  // The second keyframe's feature shows a point from now on.
  void take(int j) { is_free_[static_cast<std::size_t>(j)] = 0; }

  // The point that features `i` and `j` show, if they agree on one.
  std::optional<Eigen::Vector3d> point(int i, int j) const {
    const std::array<View, 2> views = {View{first_.T_cw, pixel_of(first_, i)},
                                       {second_.T_cw, pixel_of(second_, j)}};
    const double parallax_cosine = ray_cosine(camera_, views[0], views[1]);
    const double stereo_cosine = std::min(stereo_parallax(first_, i), stereo_parallax(second_, j));
    std::optional<Eigen::Vector3d> X;
    if (parallax_cosine < stereo_cosine && parallax_cosine < kCosLeastParallax) {
      X = triangulate(camera_, views);
    } else if (stereo_cosine < 1.0) {
      const bool from_first = stereo_parallax(first_, i) <= stereo_parallax(second_, j);
      X = from_first ? back_projected(first_, i) : back_projected(second_, j);
    }
    if (!X || !agrees(first_, i, *X) || !agrees(second_, j, *X)) return std::nullopt;
    return X;
  }

 private:
  // Cosine of the angle under which a feature's point sees the stereo baseline; 1 without stereo depth.
  double stereo_parallax(const KeyFrame& keyframe, int i) const {
    if (!keyframe.features->has_stereo(i)) return 1.0;
    const double depth = keyframe.features->depth[static_cast<std::size_t>(i)];
    return std::cos(2.0 * std::atan2(camera_.baseline / 2.0, depth));
  }
  Eigen::Vector3d back_projected(const KeyFrame& keyframe, int i) const {
    const Eigen::Vector2d pixel = pixel_of(keyframe, i);
    const double depth = keyframe.features->depth[static_cast<std::size_t>(i)];
    return keyframe.T_cw.inverse() * camera_.back_project(pixel.x(), pixel.y(), depth);
  }
  bool agrees(const KeyFrame& keyframe, int i, const Eigen::Vector3d& X) const {
    return within_gate(camera_, keyframe.T_cw * X, measurement_of(keyframe.view(), i, scales_));
  }

  const StereoCamera& camera_;
  const KeyFrame &first_, &second_;
  const std::vector<double>& scales_;
  double nearest_depth_;
  SE3 T_21_;
  Eigen::Matrix3d F_;
  std::vector<char> is_free_;  // features of the second keyframe that show no point yet
};

}  // namespace

int create_stereo_points(KeyFrame* keyframe, Map& map, const PointCreationSettings& settings) {
  const FeatureView features = keyframe->view();
  std::vector<std::pair<float, int>> by_depth;
  for (int i = 0; i < features.size(); ++i) {
    if (features.has_stereo(i) && !features.is_movable(i)) {
      by_depth.emplace_back(features.depth(i), i);
    }
  }
  std::sort(by_depth.begin(), by_depth.end());
  const SE3 T_wc = keyframe->T_cw.inverse();
  int seen = 0, created = 0;
  for (const auto& [depth, i] : by_depth) {
    if (depth > close_depth(map.camera(), settings) && seen >= settings.fewest_stereo_points) break;
    ++seen;
    if (!is_free(*keyframe, i)) continue;
    const FeaturePixel pixel = features.pixel(i);
    map.add_point(T_wc * map.camera().back_project(pixel.u, pixel.v, depth), keyframe, i);
    ++created;
  }
  return created;
}

int triangulate_with_neighbours(KeyFrame* keyframe, Map& map, const PointCreationSettings& settings) {
  int created = 0, searched = 0;
  for (const Covisible& c : std::vector<Covisible>(keyframe->covisibles)) {
    if (searched++ >= settings.neighbours) break;
    const Eigen::Vector3d between = camera_centre(keyframe->T_cw) - camera_centre(c.keyframe->T_cw);
    if (between.norm() < map.camera().baseline) continue;  // stereo sees more parallax than this pair
    PairSearch search(map.camera(), *keyframe, *c.keyframe, map.scales(), settings.nearest_depth);
    for (int i = 0; i < keyframe->features->size(); ++i) {
      if (!is_free(*keyframe, i)) continue;
      const int j = search.partner(i);
      if (j < 0) continue;
      const std::optional<Eigen::Vector3d> X = search.point(i, j);
      if (!X) continue;
      MapPoint* point = map.add_point(*X, keyframe, i);
      map.add_observation(point, c.keyframe, j);
      search.take(j);
      map.update_point(point);
      ++created;
    }
  }
  return created;
}

}  // namespace penumbra::slam
