#include "nn/tensor/feature_map.h"

#include <algorithm>
#include <cstring>

#include "nn/base/error.h"

namespace penumbra::nn {

FeatureMap::FeatureMap(Arena& arena, Batch batch, int channels, int height, int width, int border, int block)
    : batch_(batch), channels_(channels), height_(height), width_(width), border_(border), block_(block) {
  data_ = arena.allocate(static_cast<std::size_t>(image_stride()) * static_cast<std::size_t>(batch.capacity));
  if (border == 0) return;
  const std::size_t side = static_cast<std::size_t>(border) * block;
  for (int n = 0; n < batch.images; ++n) {
    for (int b = 0; b < blocks(); ++b) {
      std::fill_n(pixel(n, b, -border, -border), border * row_stride(), 0.0F);
      std::fill_n(pixel(n, b, height, -border), border * row_stride(), 0.0F);
      for (int y = 0; y < height; ++y) {
        std::fill_n(pixel(n, b, y, -border), side, 0.0F);
        std::fill_n(pixel(n, b, y, width), side, 0.0F);
      }
    }
  }
}

FeatureMap to_feature_map(const Tensor& tensor, Arena& arena, int border, int block) {
  if (tensor.shape.size() != 4)
    throw InputError("feature map", "a tensor [N, C, H, W]", to_string(tensor.shape));
  const auto extent = [&](std::size_t axis) { return static_cast<int>(tensor.extent(axis)); };
  FeatureMap map(arena, extent(0), extent(1), extent(2), extent(3), border, block);
  for (int n = 0; n < map.images(); ++n) {
    for (int c = 0; c < map.blocks() * block; ++c) {
      for (int y = 0; y < map.height(); ++y) {
        for (int x = 0; x < map.width(); ++x) {
          map.pixel(n, c / block, y, x)[c % block] = c < map.channels() ? tensor.at(n, c, y, x) : 0.0F;
        }
      }
    }
  }
  return map;
}

Tensor to_tensor(const FeatureMap& map) {
  Tensor tensor({map.images(), map.channels(), map.height(), map.width()});
  for (int n = 0; n < map.images(); ++n) {
    for (int c = 0; c < map.channels(); ++c) {
      for (int y = 0; y < map.height(); ++y) {
        for (int x = 0; x < map.width(); ++x) {
          tensor.at(n, c, y, x) = map.pixel(n, c / map.block(), y, x)[c % map.block()];
        }
      }
    }
  }
  return tensor;
}

FeatureMap with_border(const FeatureMap& map, Arena& arena, int border) {
  FeatureMap copy(arena, map.batch(), map.channels(), map.height(), map.width(), border, map.block());
  const std::size_t row = static_cast<std::size_t>(map.width()) * map.block() * sizeof(float);
  for (int n = 0; n < map.images(); ++n) {
    for (int b = 0; b < map.blocks(); ++b) {
      for (int y = 0; y < map.height(); ++y) {
        std::memcpy(copy.pixel(n, b, y, 0), map.pixel(n, b, y, 0), row);
      }
    }
  }
  return copy;
}

}  // namespace penumbra::nn
