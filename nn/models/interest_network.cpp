#include "nn/models/interest_network.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "nn/base/error.h"
#include "nn/layers/upsample.h"

namespace penumbra::nn {

namespace {

constexpr int kCell = 8, kStride = 16;
constexpr float kUsualBatchNormEps = 1e-5F;
constexpr int kMostChannelsOfAll = 4096;  // more is a damaged file, whose network would not fit into memory

// The outputs of a layer of that name, or a usual number where it is missing, for the error's sake.
int outputs_of(const WeightReader& weights, const std::string& name, int usual) {
  const Shape shape = weights.shape(name);
  if (shape.empty()) return usual;
  if (shape.front() < 1 || shape.front() > kMostChannelsOfAll) {
    throw InputError(weights.source() + ", " + name,
                     fmt::format("1 to {} output channels", kMostChannelsOfAll), to_string(shape));
  }
  return static_cast<int>(shape.front());
}

Conv2d convolution(WeightReader& weights, const std::string& name, int inputs, int outputs, int stride,
                   int input_block = kBlock) {
  Conv2dOptions options;
  options.stride = stride;
  options.padding = 1;
  options.activation = Activation::relu;
  options.format = input_block == kBlock ? weights.format(name) : weights.uncalibrated_format();
  const Shape shape{outputs, inputs, 3, 3};
  if (weights.has(name + ".conv.bias")) {
    return {weights.tensor(name + ".conv.weight", shape), weights.vector(name + ".conv.bias", outputs),
            options, input_block};
  }
  const FoldedConvolution folded =
      weights.folded(name + ".conv", shape, name + ".bn", weights.batch_norm_eps(kUsualBatchNormEps));
  return {folded.weight, folded.bias, options, input_block};
}

Conv2d pointwise(WeightReader& weights, const std::string& name, int inputs, int outputs) {
  return {
      weights.tensor(name + ".weight", {outputs, inputs, 1, 1}), weights.vector(name + ".bias", outputs), {}};
}

void make_softmax(std::span<float> x) { softmax(x); }

void make_unit_length(std::span<float> x) {
  float squares = 0.0F;
  for (const float value : x) squares += value * value;
  const float factor = squares > 0.0F ? 1.0F / std::sqrt(squares) : 0.0F;
  for (float& value : x) value *= factor;
}

// Row by row the cells of `map` from (left, top) on, each made something of by `finish`.
template <class Finish>
void copy_cells(const FeatureMap& map, int left, int top, int width, int height, std::vector<float>& out,
                Finish finish) {
  const auto channels = static_cast<std::size_t>(map.channels());
  out.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * channels);
  float* cell = out.data();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x, cell += channels) {
      for (int c = 0; c < map.channels(); ++c)
        cell[c] = map.pixel(0, c / kBlock, top + y, left + x)[c % kBlock];
      finish(std::span<float>(cell, channels));
    }
  }
}

}  // namespace

bool is_interest_network(const StateDict& weights) {
  return weights.tensors.contains("encoder.0.conv.weight") && weights.tensors.contains("embedding.weight");
}

InterestNetwork::InterestNetwork(const StateDict& state_dict, InterestConfig config) : config_(config) {
  WeightReader weights(state_dict, config_.precision);
  weights.expect_metadata("network", "interest");
  const int c2 = outputs_of(weights, "encoder.0.conv.weight", 16);
  const int c4 = outputs_of(weights, "encoder.1.conv.weight", 32);
  const int c8 = outputs_of(weights, "encoder.3.conv.weight", 64);
  const int c16 = coarse_channels_ = outputs_of(weights, "coarse.0.conv.weight", 96);
  stem_ = convolution(weights, "encoder.0", 3, c2, 2, kImageBlock);
  down4_ = convolution(weights, "encoder.1", c2, c4, 2);
  unit4_ = convolution(weights, "encoder.2", c4, c4, 1);
  down8_ = convolution(weights, "encoder.3", c4, c8, 2);
  unit8_[0] = convolution(weights, "encoder.4", c8, c8, 1);
  unit8_[1] = convolution(weights, "encoder.5", c8, c8, 1);
  down16_ = convolution(weights, "coarse.0", c8, c16, 2);
  unit16_ = convolution(weights, "coarse.1", c16, c16, 1);
  if (weights.has("attention.gamma")) {
    const int width = attention_width_ = outputs_of(weights, "attention.f.weight", c16 / 8);
    SelfAttentionWeights tensors;
    tensors.f = weights.tensor("attention.f.weight", {width, c16, 1, 1});
    tensors.g = weights.tensor("attention.g.weight", {width, c16, 1, 1});
    tensors.h = weights.tensor("attention.h.weight", {c16, c16, 1, 1});
    tensors.f_bias = weights.vector("attention.f.bias", width);
    tensors.g_bias = weights.vector("attention.g.bias", width);
    tensors.h_bias = weights.vector("attention.h.bias", c16);
    tensors.gamma = weights.vector("attention.gamma", 1).front();
    attention_.emplace(tensors);
  }
  lateral_ = pointwise(weights, "lateral", c16, c8);
  decoder_ = convolution(weights, "decoder", c8, c8, 1);
  classes_ = pointwise(weights, "classes", c8, outputs_of(weights, "classes.weight", 11));
  embedding_ = pointwise(weights, "embedding", c8, outputs_of(weights, "embedding.weight", 32));
  weights.finish("interest network");
}

InterestNetwork::Output InterestNetwork::forward(FeatureMap image, Arena& arena) const {
  // Maps that a 3 x 3 convolution reads get a border of 1.
  FeatureMap x = stem_(image, arena, 1);
  image = FeatureMap();  // here and below: gives its memory back
  x = down4_(x, arena, 1);
  x = unit4_(x, arena, 1, &x);
  x = down8_(x, arena, 1);
  for (const Conv2d& unit : unit8_) x = unit(x, arena, 1, &x);
  FeatureMap coarse = down16_(x, arena, 1);
  coarse = unit16_(coarse, arena, 0, &coarse);
  if (attention_) attention_->apply(coarse, arena);
  add_upsampled(lateral_(coarse, arena), x);
  coarse = FeatureMap();
  x = decoder_(x, arena);
  return {classes_(x, arena), embedding_(x, arena)};
}

Letterbox InterestNetwork::letterbox_for(const ByteView& image) const {
  const double pixels = static_cast<double>(image.width) * image.height;
  const double scale = std::min(1.0, std::sqrt(config_.most_pixels / std::max(pixels, 1.0)));
  Letterbox letterbox;
  letterbox.size = std::max(1, static_cast<int>(std::lround(scale * std::max(image.width, image.height))));
  letterbox.stride = kStride;
  return letterbox;
}

void InterestNetwork::operator()(const ByteView& image, Arena& arena, InterestMap& map) const {
  const Letterbox letterbox = letterbox_for(image);
  const LetterboxFrame frame = letterbox_frame(image, letterbox);
  const Arena::Pass pass(arena, this, frame.map_height, frame.map_width);
  const Output output = forward(letterbox_image(image, letterbox, arena, kImageBorder), arena);
  // Cells that show any of the image; a frame is narrower than two cells.
  const int first_x = frame.left / kCell, first_y = frame.top / kCell;
  const int end_x = (frame.left + frame.width + kCell - 1) / kCell;
  const int end_y = (frame.top + frame.height + kCell - 1) / kCell;
  map.width = end_x - first_x;
  map.height = end_y - first_y;
  map.classes = classes();
  map.embedding = embedding();
  map.size = kCell / frame.scale;
  map.left = static_cast<float>(first_x * kCell - frame.left) / frame.scale;
  map.top = static_cast<float>(first_y * kCell - frame.top) / frame.scale;
  copy_cells(output.logits, first_x, first_y, map.width, map.height, map.probabilities, make_softmax);
  copy_cells(output.embedding, first_x, first_y, map.width, map.height, map.embeddings, make_unit_length);
}

double InterestNetwork::multiply_adds(int height, int width) const {
  double sum = stem_.multiply_adds(height, width) + down4_.multiply_adds(height / 2, width / 2) +
               unit4_.multiply_adds(height / 4, width / 4) + down8_.multiply_adds(height / 4, width / 4) +
               down16_.multiply_adds(height / 8, width / 8) + unit16_.multiply_adds(height / 16, width / 16) +
               lateral_.multiply_adds(height / 16, width / 16);
  for (const Conv2d* layer : {&unit8_[0], &unit8_[1], &decoder_, &classes_, &embedding_})
    sum += layer->multiply_adds(height / 8, width / 8);
  if (attention_) {
    const double pixels = static_cast<double>(height / 16) * (width / 16);
    const double c = coarse_channels_, d = attention_width_;
    sum += pixels * pixels * (c + d) + pixels * c * (c + 2.0 * d);
  }
  return sum;
}

}  // namespace penumbra::nn
