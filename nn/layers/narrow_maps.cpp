#include "nn/layers/narrow_maps.h"

#include <algorithm>

#include "nn/base/ceil_div.h"
#include "nn/base/error.h"
#include "nn/base/parallel.h"
#include "nn/simd/tile_unit.h"

namespace penumbra::nn {

namespace {

const LineKernels& kernels_of_lines() {
  const LineKernels* kernels = line_kernels();
  if (kernels == nullptr)
    throw Error("maps of narrow numbers need kernels that this processor does not have");
  return *kernels;
}

LineLayout layout_of(const FeatureMap& map) {
  const int bytes = element_size(map.numbers().precision);
  return {std::ptrdiff_t{map.block()} * bytes, map.block_stride() * bytes, map.numbers()};
}

}  // namespace

FeatureMap in_numbers(const FeatureMap& map, const Numbers& numbers, Arena& arena) {
  const LineKernels& lines = kernels_of_lines();
  FeatureMap result(arena, map.batch(), map.channels(), map.height(), map.width(), map.border(), numbers);
  parallel_for({map.images(), map.height()}, 1, [&](int n, int y) {
    ConvertLinesArguments a;
    a.from = map.line(n, 0, y, 0);
    a.from_layout = layout_of(map);
    a.from_channels = map.blocks() * map.block();
    a.to = result.line(n, 0, y, 0);
    a.to_layout = layout_of(result);
    a.to_channels = result.blocks() * result.block();
    a.pixels = map.width();
    lines.convert_lines(a);
  });
  return result;
}

FeatureMap split_image(const FeatureMap& image, Arena& arena) {
  if (image.block() != kImageBlock || image.channels() > kImageBlock) {
    throw InputError("split_image", fmt::format("an image of at most {} channels", kImageBlock),
                     fmt::format("{} channels in blocks of {}", image.channels(), image.block()));
  }
  const LineKernels& lines = kernels_of_lines();
  const int border = image.border(), rows = image.height() + 2 * border;
  FeatureMap result(arena, image.batch(), image.channels(), image.height(), image.width(), border,
                    kSplitImageBlock, {Precision::bf16, {}});
  parallel_for({image.images(), rows}, 1, [&](int n, int row) {
    SplitPixelsArguments a;
    a.from = image.pixel(n, 0, row - border, -border);
    a.to = reinterpret_cast<std::uint16_t*>(result.line(n, 0, row - border, -border));
    a.pixels = image.width() + 2 * border;
    lines.split_pixels(a);
  });
  return result;
}

void dot_row(const FeatureMap& map, int n, int row, const float* weights, float* dots) {
  kernels_of_lines().dot_lines(
      {map.line(n, 0, row, 0), layout_of(map), weights, map.width(), map.channels(), dots});
}

FeatureMap sum_with_upsampled(const FeatureMap& fine, const FeatureMap& coarse, const Numbers& numbers,
                              Arena& arena, int output_border) {
  if (fine.images() != coarse.images() || fine.channels() != coarse.channels()) {
    throw InputError("sum_with_upsampled",
                     fmt::format("{} images of {} channels", fine.images(), fine.channels()),
                     fmt::format("{} of {}", coarse.images(), coarse.channels()));
  }
  const LineKernels& lines = kernels_of_lines();
  FeatureMap sum(arena, fine.batch(), fine.channels(), fine.height(), fine.width(), output_border, numbers);
  const float row_scale = static_cast<float>(coarse.height()) / static_cast<float>(fine.height());
  parallel_for({fine.images(), fine.height()}, 1, [&](int n, int y) {
    const int row = std::min(static_cast<int>(static_cast<float>(y) * row_scale), coarse.height() - 1);
    AddLinesArguments a;
    a.fine = fine.line(n, 0, y, 0);
    a.fine_layout = layout_of(fine);
    a.coarse = coarse.line(n, 0, row, 0);
    a.coarse_layout = layout_of(coarse);
    a.column_scale = static_cast<float>(coarse.width()) / static_cast<float>(fine.width());
    a.last_column = coarse.width() - 1;
    a.sum = sum.line(n, 0, y, 0);
    a.sum_layout = layout_of(sum);
    a.pixels = fine.width();
    a.channels = ceil_div(fine.channels(), kBlock) * kBlock;
    lines.add_lines(a);
  });
  return sum;
}

}  // namespace penumbra::nn
