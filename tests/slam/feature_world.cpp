#include "tests/slam/feature_world.h"

#include <cmath>
#include <numbers>

#include "nn/base/counter_random.h"

namespace penumbra::test {

using namespace slam;

namespace {

constexpr int kPoints = 16000;
constexpr int kLevels = 8;
constexpr double kScaleStep = 1.2;
constexpr double kFinestDistance = 18.0;  // metres from which a point is found on level 0
constexpr double kFarthest = 14.0;        // metres
constexpr double kPixelNoise = 0.3;       // +-
constexpr double kBitNoise = 0.02;        // share of the descriptor's bits

}  // namespace

FeatureWorld::FeatureWorld(std::uint64_t seed) {
  camera_ = {
      .fx = 360.0, .fy = 360.0, .cx = 310.0, .cy = 94.0, .baseline = 0.54, .width = 620, .height = 188};
  for (std::uint64_t i = 0; i < kPoints; ++i) {
    const auto uniform = [&](std::uint64_t k) { return counter_uniform(seed, 8 * i + k); };
    // On both sides of the road, in its frame: the origin is on the road, the centre to the right.
    const double angle = 2.0 * std::numbers::pi * uniform(0);
    const double side = uniform(1) < 0.5 ? -1.0 : 1.0;
    const double radius = kRadius + side * (3.0 + 6.0 * uniform(2));
    points_.emplace_back(kRadius - radius * std::cos(angle), -3.0 + 4.5 * uniform(3),
                         radius * std::sin(angle));
    Descriptor descriptor{};
    for (std::uint64_t w = 0; w < descriptor.size(); ++w) {
      descriptor[w] = counter_random(seed + 1, 8 * i + w);
    }
    descriptors_.push_back(descriptor);
  }
}

std::vector<double> FeatureWorld::scales() const {
  std::vector<double> scales = {1.0};
  while (scales.size() < kLevels) scales.push_back(scales.back() * kScaleStep);
  return scales;
}

SE3 FeatureWorld::T_cw(double steps) const {
  const double angle = 2.0 * std::numbers::pi * steps / kKeyframesPerLap;
  SE3 T_wc;
  T_wc.rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T_wc.translation = {kRadius * (1.0 - std::cos(angle)), 0.0, kRadius * std::sin(angle)};
  return T_wc.inverse();
}

std::shared_ptr<FrameFeatures> FeatureWorld::view(const SE3& T_cw, std::uint64_t noise_seed,
                                                  std::vector<int>& seen) const {
  auto view = std::make_shared<FrameFeatures>();
  seen.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::Vector3d p = T_cw * points_[i];
    if (p.z() < 1.0 || p.norm() > kFarthest) continue;
    Eigen::Vector3d pixel = camera_.project_stereo(p);
    if (!camera_.in_image(pixel.head<2>()) || pixel.z() < 0.0) continue;
    const auto uniform = [&](std::uint64_t k) { return counter_uniform(noise_seed, 1024 * i + k); };
    for (int k = 0; k < 3; ++k)
      pixel[k] += kPixelNoise * (2.0 * uniform(static_cast<std::uint64_t>(k)) - 1.0);
    if (!camera_.in_image(pixel.head<2>()) || pixel.z() < 0.0) continue;
    Descriptor descriptor = descriptors_[i];
    for (std::size_t b = 0; b < kDescriptorBits; ++b) {
      if (uniform(8 + b) < kBitNoise) descriptor[b / 64] ^= std::uint64_t{1} << (b % 64);
    }
    const int level =
        static_cast<int>(std::lround(std::log(kFinestDistance / p.norm()) / std::log(kScaleStep)));
    view->left.keypoints.push_back({static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
                                    std::clamp(level, 0, kLevels - 1), 0.0F, 1.0F});
    view->left.descriptors.push_back(descriptor);
    view->u_right.push_back(static_cast<float>(pixel.z()));
    view->depth.push_back(static_cast<float>(camera_.depth_from_disparity(pixel.x() - pixel.z())));
    seen.push_back(static_cast<int>(i));
  }
  view->colour.assign(seen.size(), {});
  view->grid = FeatureGrid(view->left.keypoints, camera_.width, camera_.height);
  return view;
}

KeyFrame* DriftingDrive::add_keyframe(const SE3& T_cw) {
  SE3 T_wc = T_cw.inverse();
  if (last_ != nullptr) {
    T_wc = current_pose(*last_).inverse() * shift_ * SE3::exp(drift_) * last_T_cw_ * T_cw.inverse();
  }
  shift_ = SE3{};
  std::vector<int> seen;
  const auto features = world_.view(T_cw, static_cast<std::uint64_t>(1000 + frames_), seen);
  KeyFrame* keyframe = map_.add_keyframe(frames_, 0.1 * frames_, T_wc.inverse(), features);
  ++frames_;
  keyframe->submap = new_submap_ != 0 || last_ == nullptr ? new_submap_ : last_->submap;
  new_submap_ = 0;
  std::vector<MapPoint*> tracked;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const std::size_t w = static_cast<std::size_t>(seen[i]);
    if (tracked.size() <= w) tracked.resize(w + 1, nullptr);
    MapPoint* point = w < tracked_.size() ? present(tracked_[w]) : nullptr;
    if (point == nullptr) {
      point = map_.add_point(T_wc * (T_cw * world_.point(seen[i])), keyframe, static_cast<int>(i));
    } else {
      map_.add_observation(point, keyframe, static_cast<int>(i));
      map_.update_point(point);
    }
    tracked[w] = point;
  }
  tracked_ = std::move(tracked);
  last_ = keyframe;
  last_T_cw_ = T_cw;
  map_.update_covisibility(keyframe);
  return keyframe;
}

}  // namespace penumbra::test
