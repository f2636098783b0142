#include "slam/world/ground_truth_images.h"

#include <cmath>
#include <unordered_map>

namespace penumbra::slam::synthetic {

namespace {

// The ground's plane placed under an object, as a motion of space.
SE3 motion_of(const GroundPose& pose) {
  return {rotation_of(pose.heading), {pose.position.x(), 0.0, pose.position.y()}};
}

}  // namespace

cv::Mat1w encode_depth(const cv::Mat1f& depth, float per_metre) {
  cv::Mat1w encoded(depth.size());
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      const float value = std::round(per_metre * depth(row, column));
      encoded(row, column) = value < 65535.5F ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
    }
  }
  return encoded;
}

cv::Mat1w encode_disparity(const cv::Mat1f& depth, const StereoCamera& camera) {
  const auto scale = static_cast<float>(256.0 * camera.fx * camera.baseline);
  cv::Mat1w encoded(depth.size());
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      const float z = depth(row, column);
      encoded(row, column) =
          z > 0.0F ? static_cast<std::uint16_t>(std::min(std::round(scale / z), 65535.0F)) : std::uint16_t{0};
    }
  }
  return encoded;
}

cv::Mat3f optical_flow(const World& world, const StereoCamera& camera, const RenderedView& view,
                       const TimedPose& now, const TimedPose& next) {
  const SE3 next_from_world = next.T_wc.inverse();
  const SE3 still = next_from_world * now.T_wc;
  // Camera to camera, for points of each object that moves.
  std::unordered_map<std::uint16_t, SE3> moving;
  for (const Object& object : world.objects) {
    if (!object.motion.moves) continue;
    const SE3 before = motion_of(pose_at(world, object, now.timestamp));
    const SE3 after = motion_of(pose_at(world, object, next.timestamp));
    moving[object.instance] = next_from_world * after * before.inverse() * now.T_wc;
  }
  cv::Mat3f flow(view.depth.size());
#pragma omp parallel for schedule(static)
  for (int row = 0; row < flow.rows; ++row) {
    for (int column = 0; column < flow.cols; ++column) {
      const float z = view.depth(row, column);
      cv::Vec3f& result = flow(row, column) = {0.0F, 0.0F, 0.0F};
      if (z <= 0.0F) continue;
      const auto found = moving.find(view.instance(row, column));
      const SE3& T = found == moving.end() ? still : found->second;
      const Eigen::Vector3d point = T * camera.back_project(column, row, static_cast<double>(z));
      if (point.z() < static_cast<double>(kNearDepth)) continue;
      const Eigen::Vector2d pixel = camera.project(point);
      result = {static_cast<float>(pixel.x() - column), static_cast<float>(pixel.y() - row), 1.0F};
    }
  }
  return flow;
}

cv::Mat3w encode_flow(const cv::Mat3f& flow) {
  cv::Mat3w encoded(flow.size());
  const auto code = [](float pixels) {
    return static_cast<std::uint16_t>(std::lround(64.0F * pixels) + 32768);
  };
  for (int row = 0; row < flow.rows; ++row) {
    for (int column = 0; column < flow.cols; ++column) {
      const cv::Vec3f& f = flow(row, column);
      const bool valid = f[2] > 0.0F && std::abs(f[0]) < 511.0F && std::abs(f[1]) < 511.0F;
      encoded(row, column) = valid ? cv::Vec3w(1, code(f[1]), code(f[0])) : cv::Vec3w(0, 0, 0);
    }
  }
  return encoded;
}

cv::Mat1b mask_image(const nn::Mask& mask, const cv::Size& size) {
  cv::Mat1b image(size, std::uint8_t{0});
  for (int row = 0; row < mask.height; ++row) {
    for (int column = 0; column < mask.width; ++column) {
      if (mask.contains(mask.x + column, mask.y + row)) image(mask.y + row, mask.x + column) = 255;
    }
  }
  return image;
}

}  // namespace penumbra::slam::synthetic
