#include "slam/sources/frame_range.h"

#include <charconv>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::slam {

namespace {

std::optional<int> parse_bound(std::string_view bound, std::string_view text) {
  if (bound.empty()) return std::nullopt;
  int value = 0;
  const auto [end, error] = std::from_chars(bound.data(), bound.data() + bound.size(), value);
  if (error != std::errc() || end != bound.data() + bound.size() || bound.front() == '-') {
    throw UsageError(
        fmt::format("expected A:B with whole numbers, such as 0:100, found '{}'", printable(text)));
  }
  return value;
}

}  // namespace

int FrameRange::size(int available, std::string_view place) const {
  const int last = end.value_or(available);
  if (last > available || begin >= last) {
    throw InputError(place, fmt::format("frames within 0:{}", available),
                     fmt::format("the range {}:{}", begin, end ? fmt::format("{}", *end) : ""));
  }
  return last - begin;
}

FrameRange parse_frame_range(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) {
    throw UsageError(fmt::format("expected A:B, such as 0:100, 50: or :50, found '{}'", printable(text)));
  }
  FrameRange range;
  range.begin = parse_bound(text.substr(0, colon), text).value_or(0);
  range.end = parse_bound(text.substr(colon + 1), text);
  if (range.end && *range.end <= range.begin) {
    throw UsageError(fmt::format("expected A:B with A < B, found '{}'", printable(text)));
  }
  return range;
}

}  // namespace penumbra::slam
