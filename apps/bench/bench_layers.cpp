// penumbra bench layers: what is no convolution, with Mask R-CNN's sizes for a 1242 x 375 image. These layers
// move memory rather than multiply, so the rate is in GB/s.
#include <fmt/format.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "apps/bench/benchmark.h"
#include "nn/base/counter_random.h"
#include "nn/io/image_transform.h"
#include "nn/layers/activations.h"
#include "nn/layers/best_scores.h"
#include "nn/layers/channel_attention.h"
#include "nn/layers/conv_transpose2d.h"
#include "nn/layers/mask_paste.h"
#include "nn/layers/nms.h"
#include "nn/layers/pooling.h"
#include "nn/layers/roi_align.h"
#include "nn/layers/spatial_attention.h"
#include "nn/layers/upsample.h"

namespace penumbra::apps {

namespace {

constexpr int kHeight = 416, kWidth = 1344;  // of the network's input

nn::Tensor random_tensor(const nn::Shape& shape) {
  nn::Tensor tensor(shape);
  std::uint32_t i = 0;
  for (float& value : tensor.values) value = counter_uniform_f32(3, i++);
  return tensor;
}

nn::FeatureMap random_map(nn::Arena& arena, int images, int channels, int height, int width) {
  return nn::to_feature_map(random_tensor({images, channels, height, width}), arena, 1);
}

// Boxes of 16 to 400 pixels, anywhere on the network's input.
std::vector<nn::Box> random_boxes(int count) {
  std::vector<nn::Box> boxes;
  for (int i = 0; i < count; ++i) {
    const auto uniform = [&](std::uint32_t stream, float low, float high) {
      return low + (high - low) * 0.5F * (1.0F + counter_uniform_f32(stream, static_cast<std::uint32_t>(i)));
    };
    const float w = uniform(1, 16.0F, 400.0F), h = uniform(2, 16.0F, 300.0F);
    const float x = uniform(3, 0.0F, kWidth - w), y = uniform(4, 0.0F, kHeight - h);
    boxes.push_back({x, y, x + w, y + h});
  }
  return boxes;
}

double megabytes(const nn::FeatureMap& map) {
  return 4e-6 * map.images() * map.channels() * map.height() * map.width();
}

class LayerTable {
 public:
  explicit LayerTable(const BenchmarkOptions& options)
      : options_(options), result_(machine_json(peak_gflops())) {
    if (options.json) return;
    print_machine(result_["peak_gflops"]);
    fmt::print("{:<44} {:>8} {:>7} {:>7} {:>7}\n", "layer", "ms", "spread", "MB", "GB/s");
  }

  // `moved`: MB that the layer has to read and write at least. Every repeat is a pass of its own, so that
  // its buffers are the same each time.
  void add(const std::string& name, double moved, const std::function<void(nn::Arena&)>& layer) {
    nn::Arena arena;
    const Timing timing = time_repeats(options_, [&] {
      const nn::Arena::Pass pass(arena, this, 0, 0);
      layer(arena);
    });
    const double rate = moved * 1e-3 / timing.median;
    result_["layers"].push_back({{"name", name},
                                 {"seconds", timing.median},
                                 {"spread", timing.spread()},
                                 {"mb_moved", moved},
                                 {"gb_per_s", rate}});
    if (options_.json) return;
    fmt::print("{:<44} {:>8.3f} {:>6.0f}% {:>7.1f} {:>7.1f}\n", name, timing.median * 1e3,
               timing.spread() * 100, moved, rate);
  }

  void finish() const {
    if (options_.json) fmt::print("{}\n", result_.dump(1));
  }

 private:
  BenchmarkOptions options_;
  nlohmann::ordered_json result_;
};

void bench_layers(const BenchmarkOptions& options) {
  LayerTable table(options);
  nn::Arena maps;

  const ByteImage image = ByteImage::filled(1242, 375, 120, 3);
  table.add("resize and normalise 1242x375", 1e-6 * (3.0 * 375 * 1242 + 16.0 * kHeight * kWidth),
            [&](nn::Arena& arena) { nn::transform_image(image, {}, arena, 3); });

  nn::FeatureMap map = random_map(maps, 1, 64, kHeight / 2, kWidth / 2);
  table.add("max pool 3x3 /2, 64 x 208 x 672", 1.25 * megabytes(map), [&](nn::Arena& arena) {
    nn::max_pool(map, {3, 2, 1}, arena);
  });
  table.add("sigmoid, 64 x 208 x 672", 2 * megabytes(map), [&](nn::Arena&) { nn::sigmoid(map); });
  table.add("silu, 64 x 208 x 672", 2 * megabytes(map), [&](nn::Arena&) { nn::silu(map); });

  map = random_map(maps, 1, 256, kHeight / 4, kWidth / 4);
  const nn::FeatureMap coarse = random_map(maps, 1, 256, kHeight / 8, kWidth / 8);
  table.add("add upsampled, 256 x 104 x 336", 2 * megabytes(map) + megabytes(coarse),
            [&](nn::Arena&) { nn::add_upsampled(coarse, map); });
  const nn::SpatialAttention spatial(random_tensor({1, 2, 7, 7}));
  table.add("spatial attention, 256 x 104 x 336", 3 * megabytes(map),
            [&](nn::Arena& arena) { spatial.apply(map, arena); });
  const nn::ChannelAttention channel(random_tensor({16, 256}), random_tensor({256, 16}));
  table.add("channel attention, 256 x 104 x 336", 3 * megabytes(map),
            [&](nn::Arena& arena) { channel.apply(map, arena); });

  std::array<nn::FeatureMap, 4> pyramid;
  std::array<nn::PyramidLevel, 4> levels;
  for (int k = 0; k < 4; ++k) {
    const auto level = static_cast<std::size_t>(k);
    pyramid[level] = random_map(maps, 1, 256, kHeight >> (2 + k), kWidth >> (2 + k));
    levels[level] = {&pyramid[level], 0.25F / static_cast<float>(1 << k)};
  }
  const std::vector<nn::Box> proposals = random_boxes(500), regions = random_boxes(16);
  table.add("RoIAlign 7x7 of 500 regions", 4e-6 * 500 * 256 * 49, [&](nn::Arena& arena) {
    nn::multi_scale_roi_align(levels, proposals, {7, 2}, arena);
  });
  table.add("RoIAlign 14x14 of 16 regions", 4e-6 * 16 * 256 * 196, [&](nn::Arena& arena) {
    nn::multi_scale_roi_align(levels, regions, {14, 2}, arena, 1);
  });
  const nn::FeatureMap mask_features = random_map(maps, 16, 256, 14, 14);
  nn::ConvTranspose2dOptions doubling;
  doubling.stride = 2;
  const nn::ConvTranspose2d upsample(random_tensor({256, 256, 2, 2}), {}, doubling);
  table.add("transposed 2x2, 16 x 256 x 14 x 14", 5 * megabytes(mask_features),
            [&](nn::Arena& arena) { upsample(mask_features, arena); });

  const nn::Tensor logits =
      random_tensor({3 * (kHeight / 4) * (kWidth / 4)});  // of the finest level's anchors
  table.add("the best 1000 of 104832 scores", 4e-6 * static_cast<double>(logits.values.size()),
            [&](nn::Arena& arena) {
              nn::BestScores best(arena, 1000);
              for (std::uint32_t i = 0; i < logits.values.size(); ++i) best.offer(logits.values[i], i);
              best.sorted();
            });
  const std::vector<nn::Box> boxes = random_boxes(5000);
  table.add("NMS of 5000 boxes, 1000 kept", 1e-6 * 5000 * 24, [&](nn::Arena& arena) {
    nn::Candidates candidates(arena, boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      candidates.add(boxes[i], counter_uniform_f32(5, static_cast<std::uint32_t>(i)),
                     static_cast<int>(i) % 5);
    }
    nn::batched_nms(candidates, {0.7F, 1000, 5}, arena);
  });
  const nn::Tensor probabilities = random_tensor({28, 28});
  nn::Mask mask;
  table.add("paste 100 masks of 300 x 200 pixels", 1e-6 * 100 * 300 * 200, [&](nn::Arena&) {
    for (int i = 0; i < 100; ++i) {
      nn::paste_mask(probabilities.values, 28, {100, 100, 400, 300}, 1242, 375, 0.5F, mask);
    }
  });
  table.finish();
}

}  // namespace

void add_layers_benchmark(CLI::App& bench) {
  auto options = std::make_shared<BenchmarkOptions>();
  CLI::App* command = bench.add_subcommand("layers", "The layers that are no convolutions");
  add_benchmark_options(command, *options);
  command->footer(
      "Examples:\n"
      "  penumbra bench layers\n"
      "  penumbra bench layers --threads 1 --isa avx2 --json\n"
      "MB are those that a layer reads and writes at the least.");
  command->callback([options] { bench_layers(*options); });
}

}  // namespace penumbra::apps
