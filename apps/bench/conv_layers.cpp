#include "apps/bench/conv_layers.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "nn/base/counter_random.h"
#include "nn/layers/narrow_maps.h"

namespace penumbra::apps {

namespace {

constexpr nn::Quantisation kAnyRange{2.0F / 255.0F, 127};  // of inputs in -1..1

nn::Tensor random_weight(const ConvShape& shape) {
  nn::Tensor weight({shape.outputs, shape.channels, shape.kernel, shape.kernel});
  for (std::size_t i = 0; i < weight.values.size(); ++i) {
    weight.values[i] = 0.05F * counter_uniform_f32(1, static_cast<std::uint32_t>(i));
  }
  return weight;
}

int input_block(const ConvShape& shape) {
  return shape.channels <= nn::kImageBlock ? nn::kImageBlock : nn::kBlock;
}

// A kernel as large as the map is a fully connected layer.
int padding_of(const ConvShape& shape) {
  return shape.kernel == shape.height && shape.kernel == shape.width ? 0 : shape.kernel / 2;
}

nn::Conv2d make_layer(const ConvShape& shape, nn::Precision precision) {
  nn::Conv2dOptions options;
  options.stride = shape.stride;
  options.padding = padding_of(shape);
  options.activation = nn::Activation::relu;
  options.format = {precision, kAnyRange, nullptr};
  return {random_weight(shape), {}, options, input_block(shape)};
}

// Values in -1..1 in these numbers.
nn::FeatureMap random_map(nn::Arena& arena, const ConvShape& shape, int channels, int height, int width,
                          int border, int block, const nn::Numbers& numbers) {
  nn::FeatureMap map(arena, shape.images, channels, height, width, border, block);
  std::uint32_t i = 0;
  for (int n = 0; n < map.images(); ++n) {
    for (int b = 0; b < map.blocks(); ++b) {
      for (int y = 0; y < map.height(); ++y) {
        float* pixels = map.pixel(n, b, y, 0);
        for (int x = 0; x < map.width() * map.block(); ++x) pixels[x] = counter_uniform_f32(2, i++);
      }
    }
  }
  return numbers == nn::Numbers{} ? std::move(map) : nn::in_numbers(map, numbers, arena);
}

}  // namespace

std::vector<ConvShape> network_shapes(int height, int width) {
  std::vector<ConvShape> shapes;
  const int blocks[] = {3, 4, 6, 3};
  shapes.push_back({"stem 7x7", 1, 3, 64, height, width, 7, 2});
  int inputs = 64;
  for (int stage = 0; stage < 4; ++stage) {
    const int h = height >> (2 + stage), w = width >> (2 + stage), middle = 64 << stage, outputs = 4 * middle;
    const int n = blocks[stage], s = stage == 0 ? 1 : 2;  // the stage's first block halves the map
    const std::string res = fmt::format("res{}", stage + 2);
    shapes.push_back({res + " first 1x1", 1, inputs, middle, h * s, w * s, 1, 1});
    if (s == 2) shapes.push_back({res + " 3x3 /2", 1, middle, middle, h * s, w * s, 3, 2});
    shapes.push_back({res + " shortcut 1x1", 1, inputs, outputs, h * s, w * s, 1, s});
    shapes.push_back({res + " 1x1 reduce", 1, outputs, middle, h, w, 1, 1, false, n - 1});
    shapes.push_back({res + " 3x3", 1, middle, middle, h, w, 3, 1, false, s == 2 ? n - 1 : n});
    shapes.push_back({res + " 1x1 expand", 1, middle, outputs, h, w, 1, 1, true, n});
    inputs = outputs;
  }
  for (int level = 2; level <= 5; ++level) {
    const int h = height >> level, w = width >> level;
    shapes.push_back({fmt::format("P{} lateral 1x1", level), 1, 64 << level, 256, h, w, 1, 1});
    shapes.push_back({fmt::format("P{} output 3x3", level), 1, 256, 256, h, w, 3, 1});
  }
  shapes.push_back({"mask head 3x3", 16, 256, 256, 14, 14, 3, 1, false, 0});
  shapes.push_back({"box head fc6", 500, 256, 1024, 7, 7, 7, 1, false, 0});
  return shapes;
}

std::vector<ConvShape> compared_shapes(int height, int width) {
  std::vector<ConvShape> compared;
  for (const ConvShape& shape : network_shapes(height, width)) {
    const std::string stage = shape.name.substr(0, 4), layer = shape.name.substr(shape.name.find(' ') + 1);
    if ((stage == "res2" || stage == "res3" || stage == "res4") &&
        (layer == "1x1 reduce" || layer == "3x3" || layer == "1x1 expand")) {
      compared.push_back(shape);
    }
  }
  return compared;
}

ConvLayer::ConvLayer(const ConvShape& shape, nn::Precision precision)
    : shape_(shape), conv_(make_layer(shape, precision)) {
  const nn::Numbers numbers = conv_.input_numbers();
  input_ = random_map(arena_, shape, shape.channels, shape.height, shape.width, padding_of(shape),
                      input_block(shape), numbers);
  const nn::FeatureMap output = conv_(input_, arena_);
  outputs_ = static_cast<double>(output.images()) * output.channels() * output.height() * output.width();
  if (shape.residual) {
    residual_ =
        random_map(arena_, shape, shape.outputs, output.height(), output.width(), 0, nn::kBlock, numbers);
  }
}

void ConvLayer::run() {
  const nn::Arena::Pass pass(arena_, this, shape_.height, shape_.width);
  // As in the network: the sum takes the residual's place. On a tile unit it never does: it has memory of the
  // pass, which it must not outlive.
  const bool in_place = shape_.residual && conv_.algorithm() != std::string_view("tiles");
  if (in_place) {
    residual_ = conv_.onto(std::move(residual_), input_, arena_, 0, conv_.input_numbers());
  } else {
    conv_(input_, arena_, 0, shape_.residual ? &residual_ : nullptr, conv_.input_numbers());
  }
}

double ConvLayer::gflop() const {
  return 2e-9 * shape_.images * conv_.multiply_adds(shape_.height, shape_.width);
}

double ConvLayer::mb_moved() const {
  const nn::Precision numbers = conv_.input_numbers().precision;
  const double inputs = static_cast<double>(shape_.images) * shape_.channels * shape_.height * shape_.width;
  const double weights =
      static_cast<double>(shape_.outputs) * shape_.channels * shape_.kernel * shape_.kernel;
  return 1e-6 * nn::element_size(numbers) * (inputs + weights + outputs_ * (shape_.residual ? 2.0 : 1.0));
}

}  // namespace penumbra::apps
