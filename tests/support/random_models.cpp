#include "tests/support/random_models.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "tests/support/random_network.h"

namespace penumbra::test {

namespace {

constexpr int kClasses = 10;  // of a ResNet

void add_norm(Shapes& shapes, const std::string& name, std::int64_t channels) {
  for (const char* part : {".weight", ".bias", ".running_mean", ".running_var"})
    shapes[name + part] = {channels};
}

// Collects the shapes of YOLOv5's convolutions.
struct Yolov5Shapes {
  bool folded;
  Shapes shapes;

  void conv(const std::string& name, int inputs, int outputs, int kernel = 1) {
    shapes[name + ".conv.weight"] = {outputs, inputs, kernel, kernel};
    if (folded) {
      shapes[name + ".conv.bias"] = {outputs};
    } else {
      add_norm(shapes, name + ".bn", outputs);
    }
  }
  void attention(const std::string& name, int channels) {
    const int squeezed = std::max(8, channels / 32);
    conv(name + ".squeeze", channels, squeezed);
    for (const char* expand : {".expand_rows", ".expand_columns"}) {
      shapes[name + expand + ".weight"] = {channels, squeezed, 1, 1};
      shapes[name + expand + ".bias"] = {channels};
    }
  }
  // ASFF of levels of these channels.
  void fusion(const std::array<int, 3>& channels) {
    for (std::size_t l = 0; l < 3; ++l) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (k != l) conv(fmt::format("asff.{}.resize.{}", l, k), channels[k], channels[l], k < l ? 3 : 1);
        shapes[fmt::format("asff.{}.weight.{}.weight", l, k)] = {1, channels[l], 1, 1};
        shapes[fmt::format("asff.{}.weight.{}.bias", l, k)] = {1};
      }
    }
  }
  void c3(const std::string& name, int inputs, int outputs, int repetitions, bool with_attention = false) {
    const int hidden = outputs / 2;
    conv(name + ".cv1", inputs, hidden);
    conv(name + ".cv2", inputs, hidden);
    conv(name + ".cv3", 2 * hidden, outputs);
    for (int i = 0; i < repetitions; ++i) {
      conv(fmt::format("{}.m.{}.cv1", name, i), hidden, hidden);
      conv(fmt::format("{}.m.{}.cv2", name, i), hidden, hidden, 3);
      if (with_attention) attention(fmt::format("{}.m.{}.attention", name, i), hidden);
    }
  }
};

}  // namespace

nn::StateDict random_resnet(int depth, int width) {
  const std::map<int, std::array<int, 4>> variants{
      {18, {2, 2, 2, 2}}, {34, {3, 4, 6, 3}}, {50, {3, 4, 6, 3}}, {101, {3, 4, 23, 3}}, {152, {3, 8, 36, 3}}};
  const bool bottleneck = depth >= 50;
  Shapes shapes;
  shapes["conv1.weight"] = {width, 3, 7, 7};
  add_norm(shapes, "bn1", width);
  std::int64_t inputs = width;
  for (int stage = 0; stage < 4; ++stage) {
    const std::int64_t middle = static_cast<std::int64_t>(width) << stage;
    const std::int64_t outputs = bottleneck ? 4 * middle : middle;
    for (int b = 0; b < variants.at(depth)[static_cast<std::size_t>(stage)]; ++b) {
      const std::string block = fmt::format("layer{}.{}.", stage + 1, b);
      const std::int64_t kernel = bottleneck ? 1 : 3;
      shapes[block + "conv1.weight"] = {middle, inputs, kernel, kernel};
      add_norm(shapes, block + "bn1", middle);
      shapes[block + "conv2.weight"] = {middle, middle, 3, 3};
      add_norm(shapes, block + "bn2", middle);
      if (bottleneck) {
        shapes[block + "conv3.weight"] = {outputs, middle, 1, 1};
        add_norm(shapes, block + "bn3", outputs);
      }
      if (b == 0 && (stage > 0 || inputs != outputs)) {
        shapes[block + "downsample.0.weight"] = {outputs, inputs, 1, 1};
        add_norm(shapes, block + "downsample.1", outputs);
      }
      inputs = outputs;
    }
  }
  shapes["fc.weight"] = {kClasses, inputs};
  shapes["fc.bias"] = {kClasses};
  return random_state(shapes, [&](const std::string& name) {
    const char* last = bottleneck ? "conv3" : "conv2";
    if (name.find(last) != std::string::npos) return 0.5;
    return name.starts_with("fc") ? 1.0 : 1.5;
  });
}

nn::StateDict random_yolov5(const RandomYolov5& options) {
  const auto channels = [&](int full) { return static_cast<int>(std::ceil(full * options.width / 8)) * 8; };
  const auto times = [&](int full) {
    return std::max(static_cast<int>(std::nearbyint(full * options.depth)), 1);
  };
  const std::array<int, 5> c{channels(64), channels(128), channels(256), channels(512), channels(1024)};
  Yolov5Shapes y{options.folded, {}};
  y.conv("model.0", 3, c[0], 6);
  const std::array<int, 4> repetitions{times(3), times(6), times(9), times(3)};
  for (int k = 0; k < 4; ++k) {
    const auto stage = static_cast<std::size_t>(k);
    y.conv(fmt::format("model.{}", 1 + 2 * k), c[stage], c[stage + 1], 3);
    y.c3(fmt::format("model.{}", 2 + 2 * k), c[stage + 1], c[stage + 1], repetitions[stage],
         options.attention);
  }
  y.conv("model.9.cv1", c[4], c[4] / 2);
  y.conv("model.9.cv2", 2 * c[4], c[4]);
  y.conv("model.10", c[4], c[3]);
  y.c3("model.13", 2 * c[3], c[3], times(3));
  y.conv("model.14", c[3], c[2]);
  y.c3("model.17", 2 * c[2], c[2], times(3));
  y.conv("model.18", c[2], c[2], 3);
  y.c3("model.20", 2 * c[2], c[3], times(3));
  y.conv("model.21", c[3], c[3], 3);
  y.c3("model.23", 2 * c[3], c[4], times(3));
  if (options.fusion) y.fusion({c[2], c[3], c[4]});
  const int outputs = 3 * (5 + options.classes + (options.masks ? 32 : 0));
  for (int level = 0; level < 3; ++level) {
    const std::string name = fmt::format("model.24.m.{}", level);
    y.shapes[name + ".weight"] = {outputs, c[static_cast<std::size_t>(2 + level)], 1, 1};
    y.shapes[name + ".bias"] = {outputs};
  }
  if (options.masks) {
    const int hidden = channels(256);
    y.conv("model.24.proto.cv1", c[2], hidden, 3);
    y.conv("model.24.proto.cv2", hidden, hidden, 3);
    y.conv("model.24.proto.cv3", hidden, 32);
  }
  return random_state(y.shapes, [](const std::string& name) {
    if (name.find("model.24.m.") != std::string::npos) return 3.0;
    const bool residual = name.find(".m.") != std::string::npos && name.find("cv2") != std::string::npos;
    return residual ? 0.7 : 1.6;
  });
}

nn::StateDict random_interest(const RandomInterest& options) {
  const auto [c2, c4, c8, c16] = options.channels;
  Yolov5Shapes y{options.folded, {}};  // whose convolutions are named alike
  const auto pointwise = [&](const std::string& name, int inputs, int outputs) {
    y.shapes[name + ".weight"] = {outputs, inputs, 1, 1};
    y.shapes[name + ".bias"] = {outputs};
  };
  y.conv("encoder.0", 3, c2, 3);
  y.conv("encoder.1", c2, c4, 3);
  y.conv("encoder.2", c4, c4, 3);
  y.conv("encoder.3", c4, c8, 3);
  y.conv("encoder.4", c8, c8, 3);
  y.conv("encoder.5", c8, c8, 3);
  y.conv("coarse.0", c8, c16, 3);
  y.conv("coarse.1", c16, c16, 3);
  if (options.attention) {
    const int width = std::max(8, c16 / 8);
    pointwise("attention.f", c16, width);
    pointwise("attention.g", c16, width);
    pointwise("attention.h", c16, c16);
    y.shapes["attention.gamma"] = {1};
  }
  pointwise("lateral", c16, c8);
  y.conv("decoder", c8, c8, 3);
  pointwise("classes", c8, options.classes);
  pointwise("embedding", c8, options.embedding);
  nn::StateDict state = random_state(y.shapes, [](const std::string& name) {
    const bool unit = name.starts_with("encoder.2") || name.starts_with("encoder.4") ||
                      name.starts_with("encoder.5") || name.starts_with("coarse.1");
    return unit || name.starts_with("attention") ? 0.7 : 1.4;
  });
  static constexpr std::array<float, 1> kGamma{0.8F};
  if (options.attention)
    state.tensors["attention.gamma"].bytes = std::as_bytes(std::span<const float>(kGamma));
  return state;
}

}  // namespace penumbra::test
