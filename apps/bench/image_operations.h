// The image operations that `penumbra bench image` times, each with all that it needs and ready to run again.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "nn/image/image.h"
#include "nn/image/point_flow.h"

namespace penumbra::apps {

// An image with corners, edges, flat areas and noise, as a camera's; the same everywhere.
ByteImage benchmark_image(int width, int height);

// What the places of the benchmark's remap are: a barrel lens that is turned a little.
struct BenchmarkMap {
  FloatImage x, y;
};
BenchmarkMap benchmark_map(const Size& size);
// Smaller by the pyramid's factor, 1.2.
Size next_level(const Size& size);

// Up to 500 corners, which are followed into the image that the map makes; levels of the pyramid.
std::vector<FlowPoint> benchmark_points(const ByteImage& grey);
constexpr int kFlowLevels = 4;

struct ImageOperation {
  std::string name;
  std::function<void()> run;
};
// On a grey image and the same in three channels.
std::vector<ImageOperation> image_operations(const ByteImage& grey);

}  // namespace penumbra::apps
