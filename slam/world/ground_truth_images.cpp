#include "slam/world/ground_truth_images.h"

#include <cmath>
#include <unordered_map>

#include "nn/base/parallel.h"

namespace penumbra::slam::synthetic {

WordImage encode_depth(const FloatImage& depth, float per_metre) {
  WordImage encoded(depth.width(), depth.height());
  for (int row = 0; row < depth.height(); ++row) {
    for (int column = 0; column < depth.width(); ++column) {
      const float value = std::round(per_metre * depth.at(column, row));
      encoded.at(column, row) = value < 65535.5F ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
    }
  }
  return encoded;
}

WordImage encode_disparity(const FloatImage& depth, const StereoCamera& camera) {
  const auto scale = static_cast<float>(256.0 * camera.fx * camera.baseline);
  WordImage encoded(depth.width(), depth.height());
  for (int row = 0; row < depth.height(); ++row) {
    for (int column = 0; column < depth.width(); ++column) {
      const float z = depth.at(column, row);
      encoded.at(column, row) =
          z > 0.0F ? static_cast<std::uint16_t>(std::min(std::round(scale / z), 65535.0F)) : std::uint16_t{0};
    }
  }
  return encoded;
}

FlowImage optical_flow(const World& world, const StereoCamera& camera, const RenderedView& view,
                       const TimedPose& now, const TimedPose& next) {
  const SE3 next_from_world = next.T_wc.inverse();
  const SE3 still = next_from_world * now.T_wc;
  // Camera to camera, for points of each object that moves.
  std::unordered_map<std::int32_t, SE3> moving;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const Object& object = world.objects[i];
    if (!object.motion.moves) continue;
    const SE3 before = placement_at(world, object, now.timestamp);
    const SE3 after = placement_at(world, object, next.timestamp);
    moving[static_cast<std::int32_t>(i)] = next_from_world * after * before.inverse() * now.T_wc;
  }
  FlowImage flow(view.depth.width(), view.depth.height());
  parallel_for(flow.height(), 8, [&](int row) {
    for (int column = 0; column < flow.width(); ++column) {
      const float z = view.depth.at(column, row);
      std::array<float, 3>& result = flow.at(column, row) = {0.0F, 0.0F, 0.0F};
      if (z <= 0.0F) continue;
      const auto found = moving.find(view.object.at(column, row));
      const SE3& T = found == moving.end() ? still : found->second;
      const Eigen::Vector3d point = T * camera.back_project(column, row, static_cast<double>(z));
      if (point.z() < static_cast<double>(kNearDepth)) continue;
      const Eigen::Vector2d pixel = camera.project(point);
      result = {static_cast<float>(pixel.x() - column), static_cast<float>(pixel.y() - row), 1.0F};
    }
  });
  return flow;
}

WordImage encode_flow(const FlowImage& flow) {
  WordImage encoded(flow.width(), flow.height(), 3);
  const auto encode = [](float pixels) {
    return static_cast<std::uint16_t>(std::lround(64.0F * pixels) + 32768);
  };
  for (int row = 0; row < flow.height(); ++row) {
    for (int column = 0; column < flow.width(); ++column) {
      const std::array<float, 3>& f = flow.at(column, row);
      const bool valid = f[2] > 0.0F && std::abs(f[0]) < 511.0F && std::abs(f[1]) < 511.0F;
      std::uint16_t* code = &encoded.at(column, row);
      code[0] = valid ? 1 : 0;
      code[1] = valid ? encode(f[1]) : std::uint16_t{0};
      code[2] = valid ? encode(f[0]) : std::uint16_t{0};
    }
  }
  return encoded;
}

ByteImage mask_image(const nn::Mask& mask, const Size& size) {
  ByteImage image = ByteImage::filled(size.width, size.height, 0);
  for (int row = 0; row < mask.height; ++row) {
    for (int column = 0; column < mask.width; ++column) {
      if (mask.contains(mask.x + column, mask.y + row)) image.at(mask.x + column, mask.y + row) = 255;
    }
  }
  return image;
}

}  // namespace penumbra::slam::synthetic
