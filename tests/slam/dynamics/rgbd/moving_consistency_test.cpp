#include "slam/dynamics/rgbd/moving_consistency.h"

#include <gtest/gtest.h>

#include <cmath>

#include "nn/base/counter_random.h"

namespace penumbra::slam {
namespace {

constexpr int kConsistencyWidth = 400, kConsistencyHeight = 300;

// Smooth noise at a place of a surface.
double texture(std::uint64_t surface, double x, double y) {
  double sum = 0.0;
  for (const double size : {7.0, 17.0}) {
    const double u = x / size, v = y / size;
    const double i = std::floor(u), j = std::floor(v);
    const auto at = [&](double a, double b) {
      return counter_uniform(surface, static_cast<std::uint64_t>((a + 1000.0) * 4096.0 + b + 1000.0));
    };
    const double s = u - i, t = v - j;
    sum += (1 - s) * (1 - t) * at(i, j) + s * (1 - t) * at(i + 1, j) + (1 - s) * t * at(i, j + 1) +
           s * t * at(i + 1, j + 1);
  }
  return 20.0 + 100.0 * sum;
}

const Rect kThing{150, 90, 90, 130};

// A camera that moves to the right sees three walls at different depths; before them a thing that moves down
// by `falls` pixels a frame, and along with the nearest wall besides.
ByteImage view(int frame, double falls) {
  ByteImage image(kConsistencyWidth, kConsistencyHeight);
  for (int y = 0; y < kConsistencyHeight; ++y) {
    for (int x = 0; x < kConsistencyWidth; ++x) {
      const int wall = 1 + (y * 7 / kConsistencyHeight) % 3;
      double value = texture(static_cast<std::uint64_t>(wall), x + 1.5 * wall * frame, y);
      if (kThing.contains(x, y)) value = texture(9, x + 6.0 * frame, y - falls * frame);
      image.at(x, y) = static_cast<std::uint8_t>(std::min(255.0, value));
    }
  }
  return image;
}

Instance thing(const char* class_name) {
  Instance instance;
  instance.class_name = class_name;
  instance.region = kThing;
  instance.mask = ByteImage::filled(kThing.width, kThing.height, 255);
  return instance;
}

TEST(MovingConsistency, FindsWhatLeavesItsEpipolarLines) {
  for (const char* name : {"person", "chair"}) {
    MovingConsistency consistency({});
    const std::vector<Instance> objects = {thing(name)};
    for (int frame = 0; frame < 4; ++frame) {
      const PointMotions points = consistency.check(frame, view(frame, 3.0), objects).front();
      EXPECT_EQ(consistency.moves(points), frame > 0) << points.followed << " " << points.moving;
      EXPECT_GE(points.followed, frame > 0 ? 6 : 0);
    }
  }
}

TEST(MovingConsistency, LeavesAloneWhatStands) {
  MovingConsistency consistency({});
  const std::vector<Instance> objects = {thing("chair")};
  for (int frame = 0; frame < 4; ++frame) {
    const PointMotions points = consistency.check(frame, view(frame, 0.0), objects).front();
    EXPECT_FALSE(consistency.moves(points)) << points.followed << " " << points.moving;
    EXPECT_GE(points.followed, frame > 0 ? 6 : 0);
  }
}

TEST(MovingConsistency, BeginsAnewAfterAGapAndAnotherSize) {
  MovingConsistency consistency({});
  const std::vector<Instance> objects = {thing("chair")};
  consistency.check(0, view(0, 3.0), objects);
  EXPECT_EQ(consistency.check(6, view(1, 3.0), objects).front().followed, 0);
  EXPECT_EQ(consistency.check(3, view(2, 3.0), objects).front().followed, 0);  // back in time
  EXPECT_GT(consistency.check(4, view(3, 3.0), objects).front().followed, 0);
  EXPECT_EQ(consistency.check(5, ByteImage::filled(kConsistencyWidth, 200, 90), objects).front().followed, 0);
  EXPECT_EQ(consistency.check(6, ByteImage::filled(5, 5, 90), objects).front().followed, 0);
}

TEST(MovingConsistency, TakesImagesWithoutCorners) {
  MovingConsistency consistency({});
  for (int frame = 0; frame < 3; ++frame) {
    EXPECT_TRUE(
        consistency.check(frame, ByteImage::filled(kConsistencyWidth, kConsistencyHeight, 50), {}).empty());
  }
}

}  // namespace
}  // namespace penumbra::slam
