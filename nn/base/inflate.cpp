#include "nn/base/inflate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "nn/base/code_table.h"

namespace penumbra {

namespace {

static_assert(std::endian::native == std::endian::little, "bits are loaded eight bytes at a time");

using namespace deflate;

constexpr int kSymbolBits = 11, kDistanceBits = 8;  // of the first tables
constexpr int kMostSymbols = 288, kMostDistances = 32, kMostLengths = 19;

constexpr std::array<std::uint16_t, 29> kLengths = {3,  4,  5,  6,   7,   8,   9,   10,  11, 13,
                                                    15, 17, 19, 23,  27,  31,  35,  43,  51, 59,
                                                    67, 83, 99, 115, 131, 163, 195, 227, 258};
constexpr std::array<std::uint8_t, 29> kLengthBits = {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                                      2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
constexpr std::array<std::uint16_t, 30> kDistances = {
    1,   2,   3,   4,   5,   7,    9,    13,   17,   25,   33,   49,   65,    97,    129,
    193, 257, 385, 513, 769, 1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
constexpr std::array<std::uint8_t, 30> kDistanceExtra = {0, 0, 0, 0, 1, 1, 2, 2,  3,  3,  4,  4,  5,  5,  6,
                                                         6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13};

Entry symbol_entry(int symbol) {
  if (symbol < 256) return entry_of(static_cast<std::uint32_t>(symbol), 1) | kBytes;
  if (symbol == 256) return kEnd;
  const std::size_t i = static_cast<std::size_t>(symbol) - 257;
  return i < kLengths.size() ? entry_of(kLengths[i], kLengthBits[i]) : kNoCode;
}
Entry distance_entry(int symbol) {
  const auto i = static_cast<std::size_t>(symbol);
  return i < kDistances.size() ? entry_of(kDistances[i], kDistanceExtra[i]) : kNoCode;
}
Entry length_entry(int symbol) { return entry_of(static_cast<std::uint32_t>(symbol), 0); }

// The next bits of the input, 64 of them at hand. Behind the end there are zeros.
class Bits {
 public:
  explicit Bits(std::string_view stream)
      : in_(reinterpret_cast<const std::uint8_t*>(stream.data())), end_(in_ + stream.size()) {}

  // Makes it 56 or more. What is loaded beyond `held_` is loaded again, the same.
  void refill() {
    if (end_ - in_ >= 8) [[likely]] {
      std::uint64_t eight;
      std::memcpy(&eight, in_, sizeof eight);
      bits_ |= eight << held_;
      in_ += (63 - held_) >> 3;
      held_ |= 56;
      return;
    }
    while (held_ < 56) {
      if (in_ < end_) {
        bits_ |= static_cast<std::uint64_t>(*in_++) << held_;
      } else {
        ++past_end_;
      }
      held_ += 8;
    }
  }
  std::uint64_t next() const { return bits_; }
  void drop(std::uint32_t count) {
    bits_ >>= count;
    held_ -= count;
  }
  std::uint64_t take(std::uint32_t count) {
    const std::uint64_t value = bits_ & ((std::uint64_t{1} << count) - 1);
    drop(count);
    return value;
  }
  // More was taken than there is.
  bool is_past_end() const { return past_end_ > held_ / 8; }
  bool is_far_past_end() const { return past_end_ > 8; }
  // Goes on at a whole byte: nothing is at hand, and what was loaded is given back. Returns the input from
  // there on; not to be called past the end.
  std::string_view give_back() {
    in_ -= held_ / 8 - past_end_;
    bits_ = 0;
    held_ = past_end_ = 0;
    return {reinterpret_cast<const char*>(in_), static_cast<std::size_t>(end_ - in_)};
  }
  void skip(std::size_t bytes) { in_ += bytes; }

 private:
  const std::uint8_t *in_, *end_;
  std::uint64_t bits_ = 0;
  std::uint32_t held_ = 0;      // bits at hand
  std::uint32_t past_end_ = 0;  // bytes of them that the input does not have
};

// Where the output grows.
struct Output {
  std::uint8_t* begin;
  std::uint8_t* at;
  std::uint8_t* end;

  // A match may reach into itself. Eight bytes at a time write up to seven too many.
  void copy_match(std::size_t distance, std::size_t length) {
    const std::uint8_t* from = at - distance;
    std::uint8_t* to = at;
    at += length;
    if (distance >= 8) {
      do {
        std::memcpy(to, from, 8);
        to += 8;
        from += 8;
      } while (to < at);
    } else if (distance == 1) {
      std::memset(to, *from, length);
    } else {
      while (to < at) *to++ = *from++;
    }
  }
};

class Inflater {
 public:
  // False where something is wrong; else `bits` is behind the last block.
  bool run(Bits& bits, Output& out) {
    while (true) {
      bits.refill();
      const bool last = bits.take(1) != 0;
      const std::uint64_t kind = bits.take(2);
      if (kind == 0) {
        if (!copy_stored(bits, out)) return false;
      } else {
        if (kind == 3 || !(kind == 1 ? read_fixed_codes() : read_own_codes(bits))) return false;
        if (!unpack(bits, out)) return false;
      }
      if (last) return !bits.is_past_end() && out.at == out.end;
    }
  }

 private:
  static bool copy_stored(Bits& bits, Output& out) {
    if (bits.is_past_end()) return false;
    const std::string_view input = bits.give_back();
    if (input.size() < 4) return false;
    const auto byte = [&](std::size_t i) { return std::uint32_t{static_cast<std::uint8_t>(input[i])}; };
    const std::uint32_t length = byte(0) | (byte(1) << 8), check = byte(2) | (byte(3) << 8);
    if (length != (check ^ 0xFFFF) || input.size() - 4 < length || out.end - out.at < std::ptrdiff_t{length})
      return false;
    std::memcpy(out.at, input.data() + 4, length);
    out.at += length;
    bits.skip(4 + length);
    return true;
  }

  bool read_fixed_codes() {
    std::array<std::uint8_t, kMostSymbols> lengths;
    for (std::size_t s = 0; s < lengths.size(); ++s)
      lengths[s] = static_cast<std::uint8_t>(s < 144 ? 8 : s < 256 ? 9 : s < 280 ? 7 : 8);
    std::array<std::uint8_t, kMostDistances> distances;
    distances.fill(5);
    return symbols_.build(lengths.data(), kMostSymbols, symbol_entry, false) &&
           distances_.build(distances.data(), kMostDistances, distance_entry, false);
  }

  bool read_own_codes(Bits& bits) {
    static constexpr std::array<std::uint8_t, kMostLengths> kOrder = {16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                                      11, 4,  12, 3, 13, 2, 14, 1, 15};
    const int symbols = static_cast<int>(bits.take(5)) + 257, distances = static_cast<int>(bits.take(5)) + 1;
    const int given = static_cast<int>(bits.take(4)) + 4;
    if (symbols > 286 || distances > 30) return false;
    std::array<std::uint8_t, kMostLengths> of_lengths{};
    for (int i = 0; i < given; ++i) {
      bits.refill();
      of_lengths[kOrder[static_cast<std::size_t>(i)]] = static_cast<std::uint8_t>(bits.take(3));
    }
    if (!lengths_.build(of_lengths.data(), kMostLengths, length_entry, false)) return false;
    std::array<std::uint8_t, kMostSymbols + kMostDistances> lengths{};
    const std::size_t count = static_cast<std::size_t>(symbols + distances);
    for (std::size_t i = 0; i < count;) {
      bits.refill();
      const Entry entry = lengths_.find(bits.next());
      if ((entry & kSpecial) != 0) return false;
      bits.drop(code_bits(entry));
      const std::uint32_t length = value_of(entry);
      if (length < 16) {
        lengths[i++] = static_cast<std::uint8_t>(length);
        continue;
      }
      if (length == 16 && i == 0) return false;
      const std::uint8_t repeated = length == 16 ? lengths[i - 1] : std::uint8_t{0};
      const std::size_t times = length == 16   ? 3 + bits.take(2)
                                : length == 17 ? 3 + bits.take(3)
                                               : 11 + bits.take(7);
      if (times > count - i) return false;
      std::fill_n(lengths.begin() + static_cast<std::ptrdiff_t>(i), times, repeated);
      i += times;
    }
    // A block whose end has no code would have none.
    if (lengths[256] == 0) return false;
    return symbols_.build(lengths.data(), symbols, symbol_entry, true) &&
           distances_.build(lengths.data() + symbols, distances, distance_entry, true);
  }

  // The symbols of a block. Up to kInflateSlack bytes behind the end may be written before it is noticed.
  bool unpack(Bits& input, Output& output) const {
    Bits bits = input;  // copies stay in registers
    Output out = output;
    bool ends = false;
    while (!ends) {
      if (out.at > out.end || bits.is_far_past_end()) return false;
      bits.refill();
      Entry entry = symbols_.find(bits.next());
      // Three times one or two bytes are at most 45 bits.
      if ((entry & kBytes) != 0) {
        put_bytes(entry, bits, out);
        entry = symbols_.find(bits.next());
        if ((entry & kBytes) != 0) {
          put_bytes(entry, bits, out);
          entry = symbols_.find(bits.next());
          if ((entry & kBytes) != 0) {
            put_bytes(entry, bits, out);
            continue;
          }
        }
        bits.refill();
      }
      bits.drop(code_bits(entry));
      if ((entry & kSpecial) != 0) {
        if ((entry & kEnd) != kEnd) return false;
        ends = true;
        continue;
      }
      // A code of 15 bits and 5 more, another and 13 more: 48.
      const std::size_t length = value_of(entry) + bits.take(more_bits(entry));
      entry = distances_.find(bits.next());
      if ((entry & kSpecial) != 0) return false;
      bits.drop(code_bits(entry));
      const std::size_t distance = value_of(entry) + bits.take(more_bits(entry));
      if (distance > static_cast<std::size_t>(out.at - out.begin)) return false;
      out.copy_match(distance, length);
    }
    if (out.at > out.end) return false;
    input = bits;
    output = out;
    return true;
  }

  static void put_bytes(Entry entry, Bits& bits, Output& out) {
    bits.drop(code_bits(entry));
    const auto both = static_cast<std::uint16_t>(value_of(entry));
    std::memcpy(out.at, &both, sizeof both);
    out.at += more_bits(entry);
  }

  CodeTable<kSymbolBits, kMostSymbols> symbols_;
  CodeTable<kDistanceBits, kMostDistances> distances_;
  CodeTable<7, kMostLengths> lengths_;  // of the codes of lengths
};

// Adler-32 (RFC 1950): both sums over many bytes at a time, in lanes.
std::uint32_t adler32(const std::uint8_t* bytes, std::size_t size) {
  constexpr std::uint32_t kModulus = 65521;
  // Of 16 groups of lanes no sum, and no sum of sums, has more than 16 bits.
  constexpr std::size_t kLanes = 32, kMostGroups = 16;
  std::uint32_t a = 1, b = 0;
  while (size >= kLanes) {
    const std::size_t groups = std::min(size / kLanes, kMostGroups);
    std::array<std::uint16_t, kLanes> sum{}, sum_of_sums{};
    for (std::size_t g = 0; g < groups; ++g, bytes += kLanes) {
      for (std::size_t i = 0; i < kLanes; ++i) {
        sum_of_sums[i] = static_cast<std::uint16_t>(sum_of_sums[i] + sum[i]);
        sum[i] = static_cast<std::uint16_t>(sum[i] + bytes[i]);
      }
    }
    // A byte of lane i counts in b once for each byte from it on: the groups behind its own, and lanes - i.
    const auto count = static_cast<std::uint32_t>(groups * kLanes);
    std::uint32_t all = 0, of_groups = 0, of_lanes = 0;
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      all += sum[i];
      of_groups += sum_of_sums[i];
      of_lanes += (static_cast<std::uint32_t>(kLanes) - i) * sum[i];
    }
    b = (b + count * a + static_cast<std::uint32_t>(kLanes) * of_groups + of_lanes) % kModulus;
    a = (a + all) % kModulus;
    size -= count;
  }
  for (; size > 0; --size) {
    a = (a + *bytes++) % kModulus;
    b = (b + a) % kModulus;
  }
  return (b << 16) | a;
}

}  // namespace

bool inflate_all(std::string_view stream, std::uint8_t* output, std::size_t size) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(stream[i]); };
  if (stream.size() < 6) return false;
  const std::uint32_t header = (std::uint32_t{byte(0)} << 8) | byte(1);
  constexpr std::uint32_t kDictionary = 0x20;
  if ((byte(0) & 0x0F) != 8 || (byte(0) >> 4) > 7 || header % 31 != 0 || (header & kDictionary) != 0)
    return false;
  Bits bits(stream.substr(2));
  Output out{output, output, output + size};
  Inflater inflater;
  if (!inflater.run(bits, out)) return false;
  const std::string_view rest = bits.give_back();
  if (rest.size() != 4) return false;
  std::uint32_t told = 0;
  for (const char part : rest) told = (told << 8) | static_cast<std::uint8_t>(part);
  return told == adler32(output, size);
}

}  // namespace penumbra
