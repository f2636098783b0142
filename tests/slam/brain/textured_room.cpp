#include "tests/slam/brain/textured_room.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nn/base/counter_random.h"
#include "tests/slam/world/synthetic.h"

namespace penumbra::test {

using slam::brain::PlanePose;

namespace {

constexpr double kPixelsPerMetre = 24.0, kWallHeight = 4.0;  // of the wallpaper
constexpr int kSigns = 32;

}  // namespace

TexturedRoom::TexturedRoom(std::uint64_t seed)
    : paper_(textured_image(static_cast<int>(8.0 * kHalf * kPixelsPerMetre) + 1,
                            static_cast<int>(kWallHeight * kPixelsPerMetre), static_cast<int>(seed))),
      seed_(seed) {
  camera_.fx = camera_.fy = 150.0;
  camera_.cx = 119.5;
  camera_.cy = 39.5;
  camera_.baseline = 0.3;
  camera_.width = 240;
  camera_.height = 80;
}

PlanePose TexturedRoom::pose(double metres) {
  const double angle = metres / kRadius;
  return {kRadius * std::cos(angle), kRadius * std::sin(angle),
          slam::brain::wrapped_angle(angle + 0.5 * std::numbers::pi)};
}

// The first wall on the ray that goes `slope` to the right per metre ahead.
TexturedRoom::Hit TexturedRoom::hit(const PlanePose& eye, double slope) const {
  const double c = std::cos(eye.heading), s = std::sin(eye.heading);
  const double dx = c + slope * s, dy = s - slope * c;  // a metre ahead
  Hit best{std::numeric_limits<double>::max(), 0.0};
  const auto try_wall = [&](double depth, int wall, double across) {
    if (depth > 0.0 && depth < best.depth) best = {depth, (2.0 * wall + 1.0) * kHalf + across};
  };
  if (dx != 0.0) {
    const double depth = ((dx > 0.0 ? kHalf : -kHalf) - eye.x) / dx;
    try_wall(depth, dx > 0.0 ? 0 : 2, eye.y + depth * dy);
  }
  if (dy != 0.0) {
    const double depth = ((dy > 0.0 ? kHalf : -kHalf) - eye.y) / dy;
    try_wall(depth, dy > 0.0 ? 1 : 3, eye.x + depth * dx);
  }
  return best;
}

ByteImage TexturedRoom::view(const PlanePose& eye) const {
  ByteImage image(camera_.width, camera_.height, 1);
  for (int u = 0; u < camera_.width; ++u) {
    const Hit wall = hit(eye, (u - camera_.cx) / camera_.fx);
    const double column = wall.along * kPixelsPerMetre;
    const int left = std::clamp(static_cast<int>(column), 0, paper_.cols - 2);
    const double share = std::clamp(column - left, 0.0, 1.0);
    for (int v = 0; v < camera_.height; ++v) {
      const double up = (v - camera_.cy) / camera_.fy * wall.depth + 0.5 * kWallHeight;  // metres on the wall
      const double row = up * kPixelsPerMetre;
      if (row < 0.0 || row >= paper_.rows - 1) {
        image.at(u, v) = row < 0.0 ? 200 : 60;  // ceiling and floor
        continue;
      }
      const int upper = static_cast<int>(row);
      const double below = row - upper;
      const auto at = [&](int y, int x) { return static_cast<double>(paper_.at<std::uint8_t>(y, x)); };
      const double value = (1.0 - below) * ((1.0 - share) * at(upper, left) + share * at(upper, left + 1)) +
                           below * ((1.0 - share) * at(upper + 1, left) + share * at(upper + 1, left + 1));
      image.at(u, v) = static_cast<std::uint8_t>(std::lround(value));
    }
  }
  return image;
}

slam::StereoImages TexturedRoom::images(const PlanePose& pose, int index) const {
  slam::StereoImages images;
  images.index = index;
  images.timestamp = 0.1 * index;
  images.left = view(pose);
  images.right = view(pose * PlanePose{0.0, -camera_.baseline, 0.0});
  return images;
}

slam::brain::Landmarks TexturedRoom::landmarks(const PlanePose& pose) const {
  slam::brain::Landmarks seen;
  for (int sign = 0; sign < kSigns; ++sign) {
    const double along = 8.0 * kHalf * (sign + 0.5) / kSigns, across = std::fmod(along, 2.0 * kHalf) - kHalf;
    const int wall = static_cast<int>(along / (2.0 * kHalf));
    const PlanePose place = wall == 0   ? PlanePose{kHalf, across, 0.0}
                            : wall == 1 ? PlanePose{across, kHalf, 0.0}
                            : wall == 2 ? PlanePose{-kHalf, across, 0.0}
                                        : PlanePose{across, -kHalf, 0.0};
    const PlanePose from_here = pose.inverse() * place;
    if (from_here.x < 0.5) continue;
    const double u = camera_.cx - camera_.fx * from_here.y / from_here.x;
    if (u < 0.0 || u >= camera_.width) continue;
    slam::brain::Landmark landmark;
    landmark.x0 = static_cast<float>(u - 4.0);
    landmark.x1 = static_cast<float>(u + 4.0);
    landmark.y0 = 36.0F;
    landmark.y1 = 44.0F;
    landmark.landmark_class = slam::brain::kSign;
    landmark.score = 0.9F;
    landmark.interest = 0.5F;
    float squares = 0.0F;
    for (std::size_t i = 0; i < landmark.descriptor.size(); ++i) {
      landmark.descriptor[i] =
          static_cast<float>(2.0 * counter_uniform(seed_, 64 * static_cast<std::uint64_t>(sign) + i) - 1.0);
      squares += landmark.descriptor[i] * landmark.descriptor[i];
    }
    for (float& value : landmark.descriptor) value /= std::sqrt(squares);
    seen.push_back(landmark);
  }
  return seen;
}

slam::Trajectory TexturedRoom::truth(double begin, double step, int frames) {
  slam::Trajectory truth;
  for (int i = 0; i < frames; ++i)
    truth.push_back({0.1 * i, slam::brain::camera_pose(pose(begin + step * i))});
  return truth;
}

}  // namespace penumbra::test
