// What is done to maps of narrow numbers besides multiplying: tile_unit.h says what is computed.

#include <algorithm>

#include "nn/simd/tile_unit/sixteen.h"
#include "nn/simd/tile_unit/unit.h"

namespace penumbra::nn::PENUMBRA_ISA {

void convert_lines(const ConvertLinesArguments& a) {
  with_stored(
      a.from_layout.numbers, [&](const auto& from) __attribute__((always_inline)) {
        with_stored(
            a.to_layout.numbers, [&](const auto& to) __attribute__((always_inline)) {
              for (int c = 0; c < a.to_channels; c += kSixteen) {
                const std::byte* in = a.from + channel_offset(a.from_layout, c);
                std::byte* out = a.to + channel_offset(a.to_layout, c);
                for (int p = 0; p < a.pixels; ++p) {
                  Floats x = {};
                  if (c < a.from_channels) from.load(in + p * a.from_layout.pixel_stride, x);
                  to.store(x, out + p * a.to_layout.pixel_stride);
                }
              }
            });
      });
}

void split_pixels(const SplitPixelsArguments& a) {
  constexpr std::ptrdiff_t kValues = 4, kPixels = kSixteen / kValues;  // of a register
  for (std::ptrdiff_t first = 0; first < a.pixels; first += kPixels) {
    const std::ptrdiff_t pixels = std::min(kPixels, a.pixels - first);
    Floats x = {}, upper;
    std::memcpy(&x, a.from + first * kValues, static_cast<std::size_t>(pixels * kValues) * sizeof(float));
    std::uint16_t uppers[kSixteen], rests[kSixteen];
    store_bf16(x, uppers);
    load_bf16(uppers, upper);
    store_bf16(x - upper, rests);
    for (std::ptrdiff_t p = 0; p < pixels; ++p) {
      std::uint16_t* to = a.to + (first + p) * 2 * kValues;
      std::memcpy(to, uppers + p * kValues, kValues * sizeof(std::uint16_t));
      std::memcpy(to + kValues, rests + p * kValues, kValues * sizeof(std::uint16_t));
    }
  }
}

void add_lines(const AddLinesArguments& a) {
  with_stored(
      a.fine_layout.numbers, [&](const auto& fine) __attribute__((always_inline)) {
        with_stored(
            a.coarse_layout.numbers, [&](const auto& coarse) __attribute__((always_inline)) {
              with_stored(
                  a.sum_layout.numbers, [&](const auto& sum) __attribute__((always_inline)) {
                    for (int c = 0; c < a.channels; c += kSixteen) {
                      const std::byte* from = a.fine + channel_offset(a.fine_layout, c);
                      const std::byte* under = a.coarse + channel_offset(a.coarse_layout, c);
                      std::byte* out = a.sum + channel_offset(a.sum_layout, c);
                      for (int p = 0; p < a.pixels; ++p) {
                        const int column =
                            std::min(static_cast<int>(static_cast<float>(p) * a.column_scale), a.last_column);
                        Floats x, y;
                        fine.load(from + p * a.fine_layout.pixel_stride, x);
                        coarse.load(under + column * a.coarse_layout.pixel_stride, y);
                        sum.store(x + y, out + p * a.sum_layout.pixel_stride);
                      }
                    }
                  });
            });
      });
}

void max_line(const MaxLineArguments& a) {
  // A scale above 0 keeps the order of 8-bit numbers, so they may be compared, and stored, as they are.
  with_stored(
      {a.precision, {}}, [&](const auto& stored) __attribute__((always_inline)) {
        for (int offset = 0; offset < kLineBytes; offset += stored.kBytes) {
          Floats best, x;
          stored.load(a.first + offset, best);
          for (int y = 0; y < a.rows; ++y) {
            const std::byte* in = a.first + y * a.row_stride + offset;
            for (int k = 0; k < a.columns; ++k, in += kLineBytes) {
              stored.load(in, x);
              keep_greater(x, best);
            }
          }
          stored.store(best, a.output + offset);
        }
      });
}

namespace {

// Sixteen channels of all bins.
template <class Map, class Output>
__attribute__((always_inline)) inline void align_sixteen(const RoiAlignLinesArguments& a, const Map& map,
                                                         const Output& output, int channel) {
  const int samples = a.row_sampling * a.column_sampling;
  const float share = samples > 0 ? 1.0F / static_cast<float>(samples) : 1.0F;
  const std::byte* in = a.map + channel_offset(a.map_layout, channel);
  std::byte* const out = a.output + channel_offset(a.output_layout, channel);
  const auto add = [&](const std::byte* from, float weight, Floats& sum) __attribute__((always_inline)) {
    Floats x, w;
    map.load(from, x);
    fill(w, weight);
    multiply_add(x, w, sum);
  };
  for (int i = 0; i < a.size; ++i) {
    for (int j = 0; j < a.size; ++j) {
      Floats sum = {};
      for (int u = 0; u < a.row_sampling; ++u) {
        const AxisSample& row = a.rows[i * a.row_sampling + u];
        const std::byte* upper = in + row.low * a.map_row_stride;
        const std::byte* lower = in + row.high * a.map_row_stride;
        for (int v = 0; v < a.column_sampling; ++v) {
          const AxisSample& column = a.columns[j * a.column_sampling + v];
          const std::ptrdiff_t left = column.low * a.map_layout.pixel_stride;
          const std::ptrdiff_t right = column.high * a.map_layout.pixel_stride;
          add(upper + left, row.low_weight * column.low_weight, sum);
          add(upper + right, row.low_weight * column.high_weight, sum);
          add(lower + left, row.high_weight * column.low_weight, sum);
          add(lower + right, row.high_weight * column.high_weight, sum);
        }
      }
      output.store(sum * share, out + i * a.output_row_stride + j * a.output_layout.pixel_stride);
    }
  }
}

}  // namespace

void roi_align_lines(const RoiAlignLinesArguments& a) {
  with_stored(
      a.map_layout.numbers, [&](const auto& map) __attribute__((always_inline)) {
        with_stored(
            a.output_layout.numbers, [&](const auto& output) __attribute__((always_inline)) {
              for (int c = 0; c < a.channels; c += kSixteen) align_sixteen(a, map, output, c);
            });
      });
}

void dot_lines(const DotLinesArguments& a) {
  with_stored(
      a.layout.numbers, [&](const auto& stored) __attribute__((always_inline)) {
        for (int p = 0; p < a.pixels; ++p) {
          const std::byte* in = a.first + p * a.layout.pixel_stride;
          Floats sum = {};
          for (int c = 0; c < a.channels; c += kSixteen) {
            Floats x, w;
            stored.load(in + channel_offset(a.layout, c), x);
            load_f32(a.weights + c, w);
            multiply_add(x, w, sum);
          }
          float dot = 0.0F;
          for (int i = 0; i < kSixteen; ++i) dot += sum[i];
          a.dots[p] = dot;
        }
      });
}

}  // namespace penumbra::nn::PENUMBRA_ISA
