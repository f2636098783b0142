// What numbers are stored as: of a layer's products, and of the values of a feature map.
//
//   f32
//   bf16   the upper half of an f32: its exponent, 8 bits of its mantissa; rounded to nearest, ties to even
//   int8   values x = scale (q - zero) with q in 0..255, weights w = scale_o q_w with q_w in -127..127
#pragma once

namespace penumbra::nn {

enum class Precision { f32, bf16, int8 };

// Of 8-bit values.
struct Quantisation {
  float scale = 1.0F;
  int zero = 0;
  bool operator==(const Quantisation&) const = default;
};

// How the values of a map are stored; int8 alone looks at `quantisation`.
struct Numbers {
  Precision precision = Precision::f32;
  Quantisation quantisation;
  bool operator==(const Numbers& other) const {
    return precision == other.precision &&
           (precision != Precision::int8 || quantisation == other.quantisation);
  }
};

// Channels that one instruction adds up in one lane: the innermost extent of packed weights.
constexpr int channel_group(Precision precision) {
  return precision == Precision::f32 ? 1 : precision == Precision::bf16 ? 2 : 4;
}

// Bytes of a value or weight.
constexpr int element_size(Precision precision) { return 4 / channel_group(precision); }

// A pixel's channels of one block lie in one cache line, whatever the numbers: 16 of f32, 32 of bf16, 64 of
// 8 bits. It is a row of a tile, too.
constexpr int kLineBytes = 64;
constexpr int line_channels(Precision precision) { return kLineBytes / element_size(precision); }

}  // namespace penumbra::nn
