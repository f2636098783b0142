#include "apps/bench/image_operations.h"

#include <cmath>
#include <memory>

#include "nn/base/counter_random.h"
#include "nn/image/blur.h"
#include "nn/image/colour.h"
#include "nn/image/fast_corners.h"
#include "nn/image/grey.h"
#include "nn/image/point_flow.h"
#include "nn/image/remap.h"
#include "nn/image/resize.h"

namespace penumbra::apps {

ByteImage benchmark_image(int width, int height) {
  constexpr std::uint64_t kSeed = 7;
  const double area = static_cast<double>(width) * height;
  ByteImage image = ByteImage::filled(width, height, 100);
  for (std::uint64_t k = 0; k < static_cast<std::uint64_t>(area / 1500.0); ++k) {
    const auto random = [&](std::uint64_t part, int below) {
      return static_cast<int>(below * counter_uniform(kSeed, 4 * k + part));
    };
    const int x0 = random(0, width), y0 = random(1, height), side = 4 + random(2, 40);
    const auto grey = static_cast<std::uint8_t>(random(3, 256));
    for (int y = y0; y < std::min(height, y0 + side); ++y)
      std::fill_n(image.row(y) + x0, std::min(side, width - x0), grey);
  }
  for (std::size_t i = 0; i < image.elements(); ++i) {
    const int noise = static_cast<int>(counter_random(kSeed + 1, i) % 7) - 3;
    image.data()[i] = static_cast<std::uint8_t>(std::clamp(image.data()[i] + noise, 0, 255));
  }
  return image;
}

BenchmarkMap benchmark_map(const Size& size) {
  BenchmarkMap map{FloatImage(size.width, size.height), FloatImage(size.width, size.height)};
  const double cx = 0.5 * size.width, cy = 0.5 * size.height, turn = 0.02, barrel = 0.04;
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const double x = (u - cx) / cx, y = (v - cy) / cx, scale = 1.0 - barrel * (x * x + y * y);
      map.x.at(u, v) = static_cast<float>(cx + cx * scale * (x - turn * y));
      map.y.at(u, v) = static_cast<float>(cy + cx * scale * (y + turn * x));
    }
  }
  return map;
}

Size next_level(const Size& size) {
  constexpr double kFactor = 1.2;
  return {std::max(1, static_cast<int>(std::lround(size.width / kFactor))),
          std::max(1, static_cast<int>(std::lround(size.height / kFactor)))};
}

std::vector<FlowPoint> benchmark_points(const ByteImage& grey) {
  constexpr int kMargin = 24, kThreshold = 20;
  constexpr std::size_t kMost = 500;
  const Rect inside{kMargin, kMargin, grey.width() - 2 * kMargin, grey.height() - 2 * kMargin};
  std::vector<Corner> corners;
  if (!inside.empty()) {
    FastCorners fast;
    fast.measure(grey, inside, kThreshold);
    fast.find(inside, kThreshold, corners);
  }
  std::vector<FlowPoint> points;
  const std::size_t step = std::max<std::size_t>(1, corners.size() / kMost);
  for (std::size_t i = 0; i < corners.size() && points.size() < kMost; i += step)
    points.push_back({static_cast<float>(corners[i].x), static_cast<float>(corners[i].y), false});
  return points;
}

std::vector<ImageOperation> image_operations(const ByteImage& grey) {
  // What the operations keep from run to run, as the SLAM does from image to image.
  struct State {
    ByteImage grey, colour, out, colour_out;
    FastCorners fast;
    std::vector<Corner> corners;
    GaussianBlur blur;
    LinearResize resize, colour_resize;
    Remap remap;
    WordImage depth, depth_out;
    double slopes = 0.0;
    ByteImage next;
    HalvingPyramid from, to;
    std::vector<FlowPoint> points, moved;
  };
  const auto s = std::make_shared<State>();
  s->grey = grey;
  s->colour = grey_to_bgr(grey.view());
  s->depth = WordImage::filled(grey.width(), grey.height(), 5000);
  const BenchmarkMap map = benchmark_map(grey.size());
  s->remap = Remap(map.x, map.y, grey.size());
  s->next = s->remap.linear(grey);
  s->from.build(grey, kFlowLevels);
  s->points = benchmark_points(grey);
  const Size smaller = next_level(grey.size());
  constexpr int kRadius = FastCorners::kRadius;
  const Rect inside{kRadius, kRadius, grey.width() - 2 * kRadius, grey.height() - 2 * kRadius};
  const auto corners = [s, inside](int threshold) {
    s->corners.clear();
    s->fast.measure(s->grey, inside, threshold);
    s->fast.find(inside, threshold, s->corners);
  };
  return {{"corners, threshold 20", [corners] { corners(20); }},
          {"corners, threshold 7", [corners] { corners(7); }},
          {"blur", [s] { s->blur.apply(s->grey, s->out); }},
          {"resize, grey", [s, smaller] { s->resize.apply(s->grey, smaller, s->out); }},
          {"resize, colour", [s, smaller] { s->colour_resize.apply(s->colour, smaller, s->colour_out); }},
          {"resize by area, colour", [s, smaller] { s->colour_out = resize_area(s->colour, smaller); }},
          {"remap, grey", [s] { s->remap.linear(s->grey, s->out); }},
          {"remap, colour", [s] { s->remap.linear(s->colour, s->colour_out); }},
          {"remap, nearest", [s] { s->remap.nearest(s->depth, s->depth_out); }},
          {"colour to grey", [s] { s->out = to_grey(s->colour); }},
          {"point flow, 500 points",
           [s] {
             s->to.build(s->next, kFlowLevels);
             s->moved = s->points;
             track_points(s->from, s->to, s->points, s->moved);
           }},
          {"slopes", [s] { s->slopes += slope_energy(s->grey, 400.0); }}};
}

}  // namespace penumbra::apps
