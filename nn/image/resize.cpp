#include "nn/image/resize.h"

#include "nn/simd/kernel_table.h"

namespace penumbra {

void LinearResize::prepare(const ByteView& in, const Size& size) {
  if (in.size() == from_ && size == to_ && in.channels == channels_) return;
  from_ = in.size();
  to_ = size;
  channels_ = in.channels;
  columns_.clear();
  column_weights_.clear();
  const double step_x = linear_step(in.width, size.width);
  for (int u = 0; u < size.width; ++u) {
    LinearTap x = linear_tap(u, step_x, in.width);
    // Where both are the outermost column, it and the one beside it, which does not count.
    if (x.low == x.high) {
      x = x.low > 0 ? LinearTap{x.low - 1, x.low, 0, LinearTap::kOne} : LinearTap{0, 1, LinearTap::kOne, 0};
    }
    for (int c = 0; c < channels_; ++c) {
      columns_.push_back(x.low * channels_ + c);
      column_weights_.push_back(static_cast<std::int16_t>(x.low_weight));
      column_weights_.push_back(static_cast<std::int16_t>(x.high_weight));
    }
  }
  rows_.clear();
  const double step_y = linear_step(in.height, size.height);
  for (int v = 0; v < size.height; ++v) rows_.push_back(linear_tap(v, step_y, in.height));
  blocks_.clear();
  constexpr int kPixels = 8, kBytes = 16;
  const int row_bytes = in.width * channels_, right = in.width > 1 ? channels_ : 0;
  for (std::size_t first = 0; first + kPixels <= columns_.size(); first += kPixels) {
    nn::ResizeBlock block;
    block.begin = std::min(columns_[first], row_bytes - kBytes);
    if (block.begin < 0) break;
    bool fits = true;
    for (std::size_t i = 0; i < kPixels; ++i) {
      const int left = columns_[first + i] - block.begin;
      fits &= left >= 0 && left + right < kBytes;
      std::uint8_t* bytes = (i < 4 ? block.low_bytes : block.high_bytes) + 4 * (i % 4);
      bytes[0] = static_cast<std::uint8_t>(left);
      bytes[2] = static_cast<std::uint8_t>(left + right);
      bytes[1] = bytes[3] = 0x80;  // a zero
    }
    if (!fits) break;
    blocks_.push_back(block);
  }
  for (std::vector<std::int16_t>& row : stretched_) row.resize(columns_.size());
}

void LinearResize::apply(const ByteView& in, const Size& size, ByteImage& out) {
  prepare(in, size);
  out.create(size.width, size.height, in.channels);
  const nn::ImageKernels& kernels = nn::kernels().image;
  nn::ResizeRowArguments a;
  a.blocks = blocks_.data();
  a.block_count = static_cast<int>(blocks_.size());
  a.columns = columns_.data();
  a.weights = column_weights_.data();
  a.right = in.width > 1 ? channels_ : 0;
  a.width = static_cast<int>(columns_.size());
  int held[2] = {-1, -1};  // which row each buffer holds
  const auto stretched = [&](int row, int keep) {
    if (held[0] == row || held[1] == row) return held[0] == row ? 0 : 1;
    const int buffer = held[0] == keep ? 1 : 0;
    a.row = in.row(row);
    a.out = stretched_[buffer].data();
    kernels.resize_row(a);
    held[buffer] = row;
    return buffer;
  };
  for (int v = 0; v < size.height; ++v) {
    const LinearTap& row = rows_[static_cast<std::size_t>(v)];
    const int upper = stretched(row.low, row.high), lower = stretched(row.high, row.low);
    kernels.resize_mix(stretched_[upper].data(), stretched_[lower].data(), row.low_weight, row.high_weight,
                       a.width, out.row(v));
  }
}

ByteImage resize_linear(const ByteView& in, const Size& size) {
  LinearResize resize;
  ByteImage out;
  resize.apply(in, size, out);
  return out;
}

namespace {

// Along one axis: the first input pixel that each output pixel covers, and the shares of it and the next
// ones, as many for all, 0 where they lie beyond.
struct Covers {
  int taps = 0;
  std::vector<int> begin;
  std::vector<float> shares;
};

Covers covers(int from, int to) {
  const double step = static_cast<double>(from) / to;
  Covers all;
  all.taps = std::min(static_cast<int>(std::ceil(step)) + 1, from);
  for (int u = 0; u < to; ++u) {
    const double begin = u * step, end = std::min<double>((u + 1) * step, from);
    all.begin.push_back(std::min(static_cast<int>(begin), from - all.taps));
    for (int i = 0; i < all.taps; ++i) {
      const int x = all.begin.back() + i;
      const double share = (std::min(end, x + 1.0) - std::max<double>(begin, x)) / step;
      all.shares.push_back(static_cast<float>(std::max(0.0, share)));
    }
  }
  return all;
}

template <int kChannels>
void mean_columns(const float* sums, const Covers& columns, std::uint8_t* out) {
  const float* share = columns.shares.data();
  for (const int begin : columns.begin) {
    const float* from = sums + begin * kChannels;
    float sum[kChannels] = {};
    for (int i = 0; i < columns.taps; ++i, ++share)
      for (int c = 0; c < kChannels; ++c) sum[c] += *share * *from++;
    // No less than 0; halves up, where the sum of shares is 1 but for its rounding.
    for (int c = 0; c < kChannels; ++c) *out++ = static_cast<std::uint8_t>(std::min(sum[c] + 0.5F, 255.0F));
  }
}

}  // namespace

ByteImage resize_area(const ByteView& in, const Size& size) {
  const Covers columns = covers(in.width, size.width), rows = covers(in.height, size.height);
  ByteImage out(size.width, size.height, in.channels);
  const std::size_t length = static_cast<std::size_t>(in.width) * static_cast<std::size_t>(in.channels);
  std::vector<float> sums(length);
  for (int v = 0; v < size.height; ++v) {
    std::fill(sums.begin(), sums.end(), 0.0F);
    for (int j = 0; j < rows.taps; ++j) {
      const float share = rows.shares[static_cast<std::size_t>(v * rows.taps + j)];
      if (share == 0.0F) continue;
      const std::uint8_t* from = in.row(rows.begin[static_cast<std::size_t>(v)] + j);
      float* to = sums.data();
      for (std::size_t i = 0; i < length; ++i) to[i] += share * static_cast<float>(from[i]);
    }
    (in.channels == 3 ? mean_columns<3> : mean_columns<1>)(sums.data(), columns, out.row(v));
  }
  return out;
}

}  // namespace penumbra
