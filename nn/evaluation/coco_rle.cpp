#include "nn/evaluation/coco_rle.h"

#include <limits>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::nn {

std::vector<std::uint32_t> mask_runs(const Mask& mask, int width, int height) {
  std::vector<std::uint32_t> runs;
  std::uint32_t length = 0;
  bool value = false;
  const auto add = [&](bool bit, std::uint32_t count) {
    if (count == 0) return;
    if (bit != value) {
      runs.push_back(length);
      length = 0;
      value = bit;
    }
    length += count;
  };
  const auto below = static_cast<std::uint32_t>(height - mask.y - mask.height);
  add(false, static_cast<std::uint32_t>(mask.x) * static_cast<std::uint32_t>(height));
  for (int x = 0; x < mask.width; ++x) {
    add(false, static_cast<std::uint32_t>(mask.y));
    for (int y = 0; y < mask.height; ++y) {
      add(mask.bits[static_cast<std::size_t>(y) * static_cast<std::size_t>(mask.width) +
                    static_cast<std::size_t>(x)] != 0,
          1);
    }
    add(false, below);
  }
  add(false, static_cast<std::uint32_t>(width - mask.x - mask.width) * static_cast<std::uint32_t>(height));
  runs.push_back(length);
  return runs;
}

std::string encode_runs(const std::vector<std::uint32_t>& runs) {
  std::string text;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::int64_t value = runs[i];
    if (i > 2) value -= runs[i - 2];  // the COCO API starts the differences at run 3
    bool more = true;
    while (more) {
      std::int64_t group = value & 0x1F;
      value >>= 5;  // arithmetic: keeps the sign
      more = (group & 0x10) != 0 ? value != -1 : value != 0;
      if (more) group |= 0x20;
      text.push_back(static_cast<char>(group + 48));
    }
  }
  return text;
}

std::vector<std::uint32_t> decode_runs(std::string_view text, std::uint64_t pixels) {
  std::vector<std::uint32_t> runs;
  std::uint64_t total = 0;
  std::size_t i = 0;
  while (i < text.size()) {
    std::int64_t value = 0;
    int shift = 0;
    bool more = true;
    while (more) {
      const int group = i < text.size() ? text[i] - 48 : -1;
      if (group < 0 || group > 0x3F || shift > 35) {
        throw InputError(fmt::format("mask run-length code, character {}", i), "a character of the code",
                         i < text.size() ? "'" + printable(text.substr(i, 1)) + "'" : "the end");
      }
      value |= static_cast<std::int64_t>(group & 0x1F) << shift;
      shift += 5;
      more = (group & 0x20) != 0;
      if (!more && (group & 0x10) != 0) value |= -1LL << shift;
      ++i;
    }
    if (runs.size() > 2) value += runs[runs.size() - 2];
    if (value < 0 || value > std::numeric_limits<std::uint32_t>::max() ||
        (total += static_cast<std::uint64_t>(value)) > pixels) {
      throw InputError(fmt::format("mask run-length code, run {}", runs.size()),
                       fmt::format("runs of {} pixels in all, less than 2^32 each", pixels),
                       fmt::format("{}", value));
    }
    runs.push_back(static_cast<std::uint32_t>(value));
  }
  return runs;
}

}  // namespace penumbra::nn
