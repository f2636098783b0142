// The table by which Huffman codes of packed data (RFC 1951) are read: an entry for every sequence of the
// next bits, and second tables for codes that are longer. See nn/base/inflate.h.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace penumbra::deflate {

inline constexpr int kLongestCode = 15;

// An entry: what the bits say, from the low end: how many bits the code takes, how many more follow it (of
// bytes: how many these are), kind, value. A value is one or two bytes, the least length or distance, or
// where in the table a second one begins.
using Entry = std::uint32_t;
inline constexpr Entry kBytes = 1U << 13, kSecondTable = 1U << 14,
                       kSpecial = 1U << 15;  // kSpecial: end, or no code
inline constexpr Entry kEnd = kSpecial | (1U << 16), kNoCode = kSpecial;
constexpr std::uint32_t code_bits(Entry e) { return e & 0x1F; }
constexpr std::uint32_t more_bits(Entry e) { return (e >> 8) & 0x1F; }
constexpr std::uint32_t value_of(Entry e) { return e >> 16; }
constexpr Entry entry_of(std::uint32_t value, int more) {
  return (value << 16) | (static_cast<std::uint32_t>(more) << 8);
}

inline std::uint32_t reversed(std::uint32_t code, int bits) {
  std::uint32_t out = 0;
  for (int i = 0; i < bits; ++i) out |= ((code >> i) & 1U) << (bits - 1 - i);
  return out;
}

// The codes of one alphabet. Behind the 2^first_bits entries of the first table lie the second ones.
template <int first_bits, int most_symbols>
class CodeTable {
 public:
  // From the length of each symbol's code, 0: it has none. False for lengths that are no code: too many
  // codes, or too few, but that one code of one bit, or none where the alphabet may stay unused, is allowed.
  bool build(const std::uint8_t* lengths, int count, Entry (*meaning)(int), bool may_be_incomplete) {
    std::array<int, kLongestCode + 1> of_length{};
    for (int s = 0; s < count; ++s) ++of_length[lengths[s]];
    of_length[0] = 0;
    int left = 1, used = 0;  // codes that are not given away yet
    for (int bits = 1; bits <= kLongestCode; ++bits) {
      left = 2 * left - of_length[static_cast<std::size_t>(bits)];
      if (left < 0) return false;
      used += of_length[static_cast<std::size_t>(bits)];
    }
    if (left > 0 && !(may_be_incomplete && (used == 0 || (used == 1 && of_length[1] == 1)))) return false;

    std::fill_n(entries_.begin(), std::size_t{1} << first_bits, kNoCode | 1U);
    std::array<std::uint32_t, kLongestCode + 2> next{};
    for (std::size_t bits = 1; bits <= kLongestCode; ++bits)
      next[bits + 1] = (next[bits] + static_cast<std::uint32_t>(of_length[bits])) << 1;
    std::size_t end = std::size_t{1} << first_bits;
    for (int bits = 1; bits <= kLongestCode; ++bits) {
      if (of_length[static_cast<std::size_t>(bits)] == 0) continue;
      for (int s = 0; s < count; ++s) {
        if (lengths[s] != bits) continue;
        const std::uint32_t code = reversed(next[static_cast<std::size_t>(bits)]++, bits);
        const Entry entry = meaning(s) | static_cast<Entry>(bits);
        if (bits <= first_bits) {
          for (std::size_t at = code; at < (std::size_t{1} << first_bits); at += std::size_t{1} << bits)
            entries_[at] = entry;
          continue;
        }
        constexpr int kSecondBits = kLongestCode - first_bits;
        Entry& first = entries_[code & ((1U << first_bits) - 1U)];
        if ((first & kSecondTable) == 0) {
          first = entry_of(static_cast<std::uint32_t>(end), kSecondBits) | kSecondTable | first_bits;
          std::fill_n(entries_.begin() + static_cast<std::ptrdiff_t>(end), std::size_t{1} << kSecondBits,
                      kNoCode | 1U);
          end += std::size_t{1} << kSecondBits;
        }
        for (std::size_t at = code >> first_bits; at < (std::size_t{1} << kSecondBits);
             at += std::size_t{1} << (bits - first_bits))
          entries_[value_of(first) + at] = entry;
      }
    }
    pair_bytes();
    return true;
  }

  // Of the code that `bits` begins with. Entries of second tables count the bits of the whole code.
  Entry find(std::uint64_t bits) const {
    const Entry entry = entries_[bits & ((1U << first_bits) - 1U)];
    if ((entry & kSecondTable) == 0) return entry;
    constexpr int kSecondBits = kLongestCode - first_bits;
    return entries_[value_of(entry) + ((bits >> first_bits) & ((1U << kSecondBits) - 1U))];
  }

 private:
  // Where the bits of an entry hold the codes of two bytes it gives both. From behind: the second is looked
  // up before it is paired itself.
  void pair_bytes() {
    for (std::size_t at = std::size_t{1} << first_bits; at-- > 0;) {
      const Entry first = entries_[at];
      if ((first & kBytes) == 0) continue;
      const Entry second = entries_[at >> code_bits(first)];
      const std::uint32_t bits = code_bits(first) + code_bits(second);
      if ((second & kBytes) == 0 || bits > first_bits) continue;
      entries_[at] = entry_of(value_of(first) | (value_of(second) << 8), 2) | kBytes | bits;
    }
  }

  // A second table has 2^(15 - first_bits) entries, and no more of them are needed than symbols.
  std::array<Entry, (std::size_t{1} << first_bits) + static_cast<std::size_t>(most_symbols) *
                                                         (std::size_t{1} << (kLongestCode - first_bits))>
      entries_;
};

}  // namespace penumbra::deflate
