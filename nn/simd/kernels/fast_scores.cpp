// FAST-9 for a whole row, without a branch a pixel. An arc of nine neighbours is brighter than the centre by
// its darkest one; with m8[j] the darkest of the eight from j on,
//
//   best arc = max over odd j of  min(m8[j], max(p[j-1], p[j+8]))
//
// covers two arcs each, those that begin at j - 1 and at j. The same with min and max exchanged finds the
// darkest arc. The centre is subtracted once, at the end: 94 operations a vector of pixels.
#include "nn/simd/kernels/kernels.h"
#include "nn/simd/kernels/vector.h"

namespace penumbra::nn::PENUMBRA_ISA {

namespace {

struct Lower {
  static Bytes of(const Bytes& a, const Bytes& b) { return min(a, b); }
};
struct Higher {
  static Bytes of(const Bytes& a, const Bytes& b) { return max(a, b); }
};

// What the best arc of nine reaches with all of its pixels.
template <class Inner, class Outer>
Bytes best_arc(const Bytes (&p)[16]) {
  Bytes two[8], four[8];
  for (int i = 0; i < 8; ++i) two[i] = Inner::of(p[2 * i + 1], p[(2 * i + 2) % 16]);
  for (int i = 0; i < 8; ++i) four[i] = Inner::of(two[i], two[(i + 1) % 8]);
  Bytes best = Inner::of(Inner::of(four[0], four[2]), Outer::of(p[0], p[9]));
  for (int i = 1; i < 8; ++i) {
    const Bytes eight = Inner::of(four[i], four[(i + 2) % 8]);
    best = Outer::of(best, Inner::of(eight, Outer::of(p[2 * i], p[(2 * i + 9) % 16])));
  }
  return best;
}

struct Circle {
  std::ptrdiff_t offset[16];
  explicit Circle(std::ptrdiff_t pitch) {
    constexpr int kX[16] = {0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
    constexpr int kY[16] = {3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1, 0, 1, 2, 3};
    for (int i = 0; i < 16; ++i) offset[i] = kY[i] * pitch + kX[i];
  }
};

// Of kBytes pixels. Of every two pixels that face each other an arc of nine holds one: where those tell that
// no pixel reaches the threshold, the others are not looked at.
void score(const std::uint8_t* centre, const Circle& circle, const Bytes& threshold, std::uint8_t* scores) {
  const Bytes v = Bytes::load_unaligned(centre);
  Bytes p[16];
  const auto load = [&](int i) { p[i] = Bytes::load_unaligned(centre + circle.offset[i]); };
  for (const int i : {0, 8, 4, 12}) load(i);
  const Bytes bright_bound = min(max(p[0], p[8]), max(p[4], p[12]));
  const Bytes dark_bound = max(min(p[0], p[8]), min(p[4], p[12]));
  const Bytes bound = max(ssub(bright_bound, v), ssub(v, dark_bound));
  if (!any(bound > threshold)) {
    Bytes(std::uint8_t{0}).store_unaligned(scores);
    return;
  }
  for (const int i : {1, 2, 3, 5, 6, 7, 9, 10, 11, 13, 14, 15}) load(i);
  const Bytes bright = ssub(best_arc<Lower, Higher>(p), v);
  const Bytes dark = ssub(v, best_arc<Higher, Lower>(p));
  const Bytes difference = max(bright, dark);
  select(difference > threshold, difference - Bytes(std::uint8_t{1}), Bytes(std::uint8_t{0}))
      .store_unaligned(scores);
}

}  // namespace

void fast_scores(const std::uint8_t* centre, std::ptrdiff_t pitch, int count, int threshold,
                 std::uint8_t* scores) {
  const Circle circle(pitch);
  const Bytes limit(static_cast<std::uint8_t>(threshold));
  int i = 0;
  for (; i + kBytes <= count; i += kBytes) score(centre + i, circle, limit, scores + i);
  if (i == count) return;
  if (count >= kBytes) {
    score(centre + count - kBytes, circle, limit, scores + count - kBytes);
    return;
  }
  // A row shorter than a vector: from a copy with room for one.
  constexpr int kRadius = 3, kWidth = 2 * kBytes, kRows = 2 * kRadius + 1;
  alignas(64) std::uint8_t copy[kRows * kWidth] = {}, out[kBytes];
  for (int y = 0; y < kRows; ++y) {
    const std::uint8_t* from = centre + (y - kRadius) * pitch - kRadius;
    for (int x = 0; x < count + 2 * kRadius; ++x) copy[y * kWidth + x] = from[x];
  }
  score(copy + kRadius * kWidth + kRadius, Circle(kWidth), limit, out);
  for (int x = 0; x < count; ++x) scores[x] = out[x];
}

void peaks(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below, int count,
           int least, std::uint8_t* is_peak) {
  const auto limit = static_cast<std::uint8_t>(least);
  for (int i = 0; i < count; ++i) {
    const auto higher = [](std::uint8_t a, std::uint8_t b) { return a > b ? a : b; };
    const std::uint8_t up = higher(higher(above[i - 1], above[i]), above[i + 1]);
    const std::uint8_t down = higher(higher(below[i - 1], below[i]), below[i + 1]);
    const std::uint8_t side = higher(here[i - 1], here[i + 1]);
    const std::uint8_t most = higher(higher(up, down), side);
    is_peak[i] = static_cast<std::uint8_t>((here[i] > most) & (here[i] >= limit));
  }
}

}  // namespace penumbra::nn::PENUMBRA_ISA
