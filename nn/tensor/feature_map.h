// A feature map, the engine's activation: N images of C channels and H x W pixels, channel-blocked.
//
// Layout: [N][ceil(C / block)][H + 2 border][W + 2 border][block]. The channels of a block lie side by
// side, so a vector register holds channels of one pixel, and a convolution's taps are constant offsets. The
// border around the pixels holds zeros: it is the zero padding of the convolution that reads the map.
//   block 16: activations in f32 (oneDNN calls this nChw16c)     block 4: images, the fourth channel 0
//   block 8: images split in two bf16 a value
//   block 32, 64: activations in bf16 and in 8 bits, which layers on a tile unit write and read; on AVX-512
//   Winograd's layers do bf16, too
// So a pixel of a block is a line of 64 bytes, whatever the numbers. pixel() is for f32, line() for all.
// Channels beyond C in the last block hold whatever the layer computes there, finite numbers: convolutions
// multiply them by zero weights.
#pragma once

#include <cstddef>

#include "nn/simd/numbers.h"
#include "nn/tensor/arena.h"
#include "nn/tensor/tensor.h"

namespace penumbra::nn {

constexpr int kBlock = 16;      // channels of a block of an f32 activation
constexpr int kImageBlock = 4;  // channels of an image's block

// The images of a map, and how many it has room for: maps of regions, whose number depends on the picture,
// ask for the same memory whatever it shows.
struct Batch {
  int images = 0, capacity = 0;
  Batch() = default;
  Batch(int count) : images(count), capacity(count) {}  // NOLINT: a number of images is a batch
  Batch(int count, int most) : images(count), capacity(most) {}
};

class FeatureMap {
 public:
  FeatureMap() = default;
  // Pixels are uninitialised, the border is zero.
  FeatureMap(Arena& arena, Batch batch, int channels, int height, int width, int border, int block = kBlock,
             const Numbers& numbers = {});
  // Activations in these numbers.
  FeatureMap(Arena& arena, Batch batch, int channels, int height, int width, int border,
             const Numbers& numbers)
      : FeatureMap(arena, batch, channels, height, width, border, line_channels(numbers.precision), numbers) {
  }

  int images() const { return batch_.images; }
  Batch batch() const { return batch_; }
  int channels() const { return channels_; }
  int height() const { return height_; }
  int width() const { return width_; }
  int border() const { return border_; }
  int block() const { return block_; }
  int blocks() const { return (channels_ + block_ - 1) / block_; }
  const Numbers& numbers() const { return numbers_; }

  // Distances in values.
  std::ptrdiff_t row_stride() const { return static_cast<std::ptrdiff_t>(width_ + 2 * border_) * block_; }
  std::ptrdiff_t block_stride() const { return row_stride() * (height_ + 2 * border_); }
  std::ptrdiff_t image_stride() const { return block_stride() * blocks(); }

  // First channel of block `b` of pixel (y, x) of image `n`; y and x may reach into the border.
  float* pixel(int n, int b, int y, int x) { return data_.data() + offset(n, b, y, x); }
  const float* pixel(int n, int b, int y, int x) const {
    return const_cast<FeatureMap*>(this)->pixel(n, b, y, x);
  }
  // The same as a place among all values, borders included, of which there are images() * image_stride().
  std::ptrdiff_t offset(int n, int b, int y, int x) const {
    return n * image_stride() + b * block_stride() + (y + border_) * row_stride() +
           static_cast<std::ptrdiff_t>(x + border_) * block_;
  }
  const float* values() const { return data_.data(); }
  // Gives the memory back, and stays a map without values: for layers that have read them already.
  void give_back() { data_ = ArenaBuffer(); }
  // pixel() of any numbers.
  std::byte* line(int n, int b, int y, int x) {
    return reinterpret_cast<std::byte*>(data_.data()) + offset(n, b, y, x) * element_size(numbers_.precision);
  }
  const std::byte* line(int n, int b, int y, int x) const {
    return const_cast<FeatureMap*>(this)->line(n, b, y, x);
  }

 private:
  Batch batch_;
  int channels_ = 0, height_ = 0, width_ = 0, border_ = 0, block_ = kBlock;
  Numbers numbers_;
  ArenaBuffer data_;
};

// Between the two layouts: [N, C, H, W] to a feature map in f32 and back.
FeatureMap to_feature_map(const Tensor& tensor, Arena& arena, int border = 0, int block = kBlock);
Tensor to_tensor(const FeatureMap& map);

// A copy with another border; what a convolution does whose input's border is narrower than its padding.
FeatureMap with_border(const FeatureMap& map, Arena& arena, int border);

}  // namespace penumbra::nn
