#include "nn/tensor/feature_map.h"

#include <algorithm>
#include <cstring>

#include "nn/base/error.h"

namespace penumbra::nn {

FeatureMap::FeatureMap(Arena& arena, Batch batch, int channels, int height, int width, int border, int block,
                       const Numbers& numbers)
    : batch_(batch),
      channels_(channels),
      height_(height),
      width_(width),
      border_(border),
      block_(block),
      numbers_(numbers) {
  const auto bytes = static_cast<std::size_t>(element_size(numbers.precision));
  const std::size_t size =
      static_cast<std::size_t>(image_stride()) * static_cast<std::size_t>(batch.capacity) * bytes;
  // A tile's row takes a line's bytes from a pixel on, and where the pixel is shorter the next ones: those
  // beyond the last pixel are 0.
  const bool short_pixels = numbers.precision != Precision::f32 && block * bytes < kLineBytes;
  data_ = arena.allocate((size + (short_pixels ? kLineBytes : 0)) / sizeof(float));
  if (short_pixels) std::memset(reinterpret_cast<std::byte*>(data_.data()) + size, 0, kLineBytes);
  if (border == 0) return;
  // What stands for 0: all bits 0, or in 8 bits the zero of their range.
  const int zero = numbers.precision == Precision::int8 ? numbers.quantisation.zero : 0;
  const auto clear = [&](int n, int b, int y, int x, std::ptrdiff_t values) {
    std::memset(line(n, b, y, x), zero, static_cast<std::size_t>(values) * bytes);
  };
  const std::ptrdiff_t side = static_cast<std::ptrdiff_t>(border) * block;
  for (int n = 0; n < batch.images; ++n) {
    for (int b = 0; b < blocks(); ++b) {
      clear(n, b, -border, -border, border * row_stride());
      clear(n, b, height, -border, border * row_stride());
      for (int y = 0; y < height; ++y) {
        clear(n, b, y, -border, side);
        clear(n, b, y, width, side);
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
  FeatureMap copy(arena, map.batch(), map.channels(), map.height(), map.width(), border, map.block(),
                  map.numbers());
  const std::size_t row = static_cast<std::size_t>(map.width()) * map.block() *
                          static_cast<std::size_t>(element_size(map.numbers().precision));
  for (int n = 0; n < map.images(); ++n) {
    for (int b = 0; b < map.blocks(); ++b) {
      for (int y = 0; y < map.height(); ++y) {
        std::memcpy(copy.line(n, b, y, 0), map.line(n, b, y, 0), row);
      }
    }
  }
  return copy;
}

}  // namespace penumbra::nn
