// The products of all layers on the tile unit: tile_unit.h says what is computed.
//
// Registers: tiles of sums 0 and 1 (first segment, outputs 0..15 and 16..31), 2 and 3 (second segment), of
// inputs 4 and 5 (the two segments), of weights 6 and 7.

#include <algorithm>
#include <limits>
#include <type_traits>

#include "nn/simd/tile_unit/sixteen.h"
#include "nn/simd/tile_unit/tiles.h"
#include "nn/simd/tile_unit/unit.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

constexpr std::ptrdiff_t kSumStride = kTileOutputs * 4;

struct Bf16Products {
  using Sum = float;
  template <int C, int A, int B>
  __attribute__((always_inline)) static void multiply(Tiles& tiles) {
    tiles.multiply_bf16<C, A, B>();
  }
};

struct Int8Products {
  using Sum = std::int32_t;
  template <int C, int A, int B>
  __attribute__((always_inline)) static void multiply(Tiles& tiles) {
    tiles.multiply_int8<C, A, B>();
  }
};

// The tiles with as many rows as the segments have pixels.
class Shapes {
 public:
  explicit Shapes(Tiles& tiles) : tiles_(tiles) {}
  ~Shapes() { tiles_.release(); }
  void set(int first_rows, int second_rows) {
    if (first_rows == first_ && second_rows == second_) return;
    first_ = first_rows;
    second_ = second_rows;
    TileConfiguration c;
    for (int t = 0; t < 8; ++t) c.column_bytes[t] = kLineBytes;
    for (const int t : {0, 1, 4}) c.rows[t] = static_cast<std::uint8_t>(first_rows);
    for (const int t : {2, 3, 5}) c.rows[t] = static_cast<std::uint8_t>(second_rows);
    for (const int t : {6, 7}) c.rows[t] = kTileRows;
    tiles_.configure(c);
  }

 private:
  Tiles& tiles_;
  int first_ = 0, second_ = 0;
};

// The sums of one or two segments and one or two times 16 outputs, all taps; [segment][16
// outputs][pixel][16].
template <class Products, int Segments, int Columns>
__attribute__((always_inline)) inline void sum_products(Tiles& tiles, const TileUnitArguments& a,
                                                        const TileSegment* segments, const std::byte* weights,
                                                        float* sums) {
  constexpr std::ptrdiff_t kRow = Columns * kLineBytes;
  const std::byte* first = segments[0].input;
  const std::byte* second = Segments > 1 ? segments[1].input : nullptr;
  const std::ptrdiff_t stride = a.input_pixel_stride;
  const std::ptrdiff_t* const taps = a.taps + a.first_tap;
  const int tap_count = a.tap_count;
  constexpr int kTile = kTileRows * kTileOutputs;
  if (a.continued) {
    tiles.load<0>(sums, kSumStride);
    if constexpr (Columns > 1) tiles.load<1>(sums + kTile, kSumStride);
    if constexpr (Segments > 1) tiles.load<2>(sums + 2 * kTile, kSumStride);
    if constexpr (Segments > 1 && Columns > 1) tiles.load<3>(sums + 3 * kTile, kSumStride);
  } else {
    tiles.zero<0>();
    if constexpr (Columns > 1) tiles.zero<1>();
    if constexpr (Segments > 1) tiles.zero<2>();
    if constexpr (Segments > 1 && Columns > 1) tiles.zero<3>();
  }
  weights += a.first_tap * kTileRows * kRow;
  for (int t = 0; t < tap_count; ++t, weights += kTileRows * kRow) {
    tiles.load<6>(weights, kRow);
    tiles.load<4>(first + taps[t], stride);
    Products::template multiply<0, 4, 6>(tiles);
    if constexpr (Columns > 1) {
      tiles.load<7>(weights + kLineBytes, kRow);
      Products::template multiply<1, 4, 7>(tiles);
    }
    if constexpr (Segments > 1) {
      tiles.load<5>(second + taps[t], stride);
      Products::template multiply<2, 5, 6>(tiles);
      if constexpr (Columns > 1) Products::template multiply<3, 5, 7>(tiles);
    }
  }
  tiles.store<0>(sums, kSumStride);
  if constexpr (Columns > 1) tiles.store<1>(sums + kTile, kSumStride);
  if constexpr (Segments > 1) tiles.store<2>(sums + 2 * kTile, kSumStride);
  if constexpr (Segments > 1 && Columns > 1) tiles.store<3>(sums + 3 * kTile, kSumStride);
}

template <class Sum>
__attribute__((always_inline)) inline void load_sums(const float* from, Floats& x) {
  if constexpr (std::is_same_v<Sum, float>) {
    load_f32(from, x);
  } else {
    using Wholes = std::int32_t __attribute__((vector_size(64)));
    Wholes whole;
    std::memcpy(&whole, from, sizeof(whole));
    x = __builtin_convertvector(whole, Floats);
  }
}

// What is done to 16 outputs' sums on their way to the map.
template <class Sum>
void finish(const TileUnitArguments& a, const TileSegment& segment, int output, float* sums) {
  Floats scale, bias, lower;
  if (a.scale != nullptr) {
    load_f32(a.scale + output - a.first_output, scale);
  } else {
    fill(scale, 1.0F);
  }
  load_f32(a.bias + output - a.first_output, bias);
  fill(lower, a.activation == Activation::relu ? 0.0F : -std::numeric_limits<float>::infinity());
  std::byte* out = segment.output + channel_offset(a.output, output);
  const std::byte* residual =
      segment.residual != nullptr ? segment.residual + channel_offset(a.residual, output) : nullptr;
  // A line is whole: where the last 16 outputs end in its middle, the rest becomes 0.
  const bool ends_in_line = a.output.numbers.precision == Precision::bf16 &&
                            output % kTileBlockOutputs == 0 &&
                            output + kTileOutputs == a.first_output + a.outputs;

  // Two passes where a function of another file comes between.
  const bool function = a.activation != Activation::none && a.activation != Activation::relu;
  const auto pass = [&](const auto& added, const auto& stored) __attribute__((always_inline)) {
    for (int p = 0; p < segment.pixels; ++p) {
      Floats x, y, r;
      load_sums<Sum>(sums + p * kTileOutputs, x);
      y = bias;
      multiply_add(x, scale, y);
      if constexpr (!std::is_same_v<std::decay_t<decltype(added)>, std::nullptr_t>) {
        added.load(residual + p * a.residual.pixel_stride, r);
        y += r;
      }
      y = lower > y ? lower : y;
      if (function) {
        store_f32(y, sums + p * kTileOutputs);
        continue;
      }
      stored.store(y, out + p * a.output.pixel_stride);
    }
  };
  const auto with_output = [&](const auto& added) __attribute__((always_inline)) {
    with_stored(
        a.output.numbers, [&](const auto& stored) __attribute__((always_inline)) { pass(added, stored); });
  };
  if (residual == nullptr) {
    with_output(nullptr);
  } else {
    with_stored(a.residual.numbers, with_output);
  }
  if (function) {
    a.activate(sums, static_cast<std::ptrdiff_t>(segment.pixels) * kTileOutputs, a.activation, a.slope);
    with_stored(
        a.output.numbers, [&](const auto& stored) __attribute__((always_inline)) {
          for (int p = 0; p < segment.pixels; ++p) {
            Floats y;
            load_f32(sums + p * kTileOutputs, y);
            stored.store(y, out + p * a.output.pixel_stride);
          }
        });
  }
  if (ends_in_line) {
    for (int p = 0; p < segment.pixels; ++p) {
      std::memset(out + p * a.output.pixel_stride + kLineBytes / 2, 0, kLineBytes / 2);
    }
  }
}

template <class Products, int Segments, int Columns>
void block(Tiles& tiles, const TileUnitArguments& a, const TileSegment* segments, const std::byte* weights,
           int output, float* kept) {
  constexpr int kTile = kTileRows * kTileOutputs;
  alignas(64) float own[kTileBlockSums];
  float* const sums = kept != nullptr ? kept : own;
  sum_products<Products, Segments, Columns>(tiles, a, segments, weights, sums);
  if (a.unfinished) return;
  for (int s = 0; s < Segments; ++s) {
    for (int c = 0; c < Columns; ++c) {
      finish<typename Products::Sum>(a, segments[s], output + c * kTileOutputs, sums + (2 * s + c) * kTile);
    }
  }
}

template <class Products>
void multiply_all(const TileUnitArguments& a) {
  Tiles tiles;
  Shapes shapes(tiles);
  const std::byte* weights = a.weights;
  float* kept = a.sums;
  for (int output = a.first_output; output < a.first_output + a.outputs; output += kTileBlockOutputs) {
    const bool wide = a.first_output + a.outputs - output >= kTileBlockOutputs;
    for (int s = 0; s < a.segment_count; s += 2) {
      const TileSegment* segments = a.segments + s;
      const bool two = s + 1 < a.segment_count;
      shapes.set(segments[0].pixels, two ? segments[1].pixels : kTileRows);
      if (two && wide) {
        block<Products, 2, 2>(tiles, a, segments, weights, output, kept);
      } else if (two) {
        block<Products, 2, 1>(tiles, a, segments, weights, output, kept);
      } else if (wide) {
        block<Products, 1, 2>(tiles, a, segments, weights, output, kept);
      } else {
        block<Products, 1, 1>(tiles, a, segments, weights, output, kept);
      }
      if (kept != nullptr) kept += kTileBlockSums;
    }
    weights += a.weight_tile_bytes;
  }
}

}  // namespace

void multiply(const TileUnitArguments& a) {
  if (a.precision == Precision::bf16) {
    multiply_all<Bf16Products>(a);
  } else {
    multiply_all<Int8Products>(a);
  }
}

void tile_product(const TileProductArguments& a) {
  Tiles tiles;
  TileConfiguration c;
  const auto shape = [&](int tile, int rows, int bytes) {
    c.rows[tile] = static_cast<std::uint8_t>(rows);
    c.column_bytes[tile] = static_cast<std::uint16_t>(bytes);
  };
  shape(0, a.rows, a.column_bytes);
  shape(1, a.rows, a.depth_bytes);
  shape(2, a.depth_bytes / 4, a.column_bytes);
  tiles.configure(c);
  tiles.load<0>(a.c, kLineBytes);
  tiles.load<1>(a.a, kLineBytes);
  tiles.load<2>(a.b, kLineBytes);
  if (a.precision == Precision::bf16) {
    tiles.multiply_bf16<0, 1, 2>();
  } else {
    tiles.multiply_int8<0, 1, 2>();
  }
  tiles.store<0>(a.c, kLineBytes);
  tiles.release();
}

double peak_loop(Precision precision, long iterations) {
  Tiles tiles;
  Shapes shapes(tiles);
  shapes.set(kTileRows, kTileRows);
  for (long i = 0; i < iterations; ++i) {
    if (precision == Precision::bf16) {
      tiles.multiply_bf16<0, 4, 6>();
      tiles.multiply_bf16<1, 4, 7>();
      tiles.multiply_bf16<2, 5, 6>();
      tiles.multiply_bf16<3, 5, 7>();
    } else {
      tiles.multiply_int8<0, 4, 6>();
      tiles.multiply_int8<1, 4, 7>();
      tiles.multiply_int8<2, 5, 6>();
      tiles.multiply_int8<3, 5, 7>();
    }
  }
  return 2.0 * static_cast<double>(iterations) * 4 * kTileRows * kTileOutputs * line_channels(precision);
}

}  // namespace penumbra::nn::PENUMBRA_ISA
