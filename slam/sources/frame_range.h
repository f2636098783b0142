// A part of a sequence, "A:B": frames A, A+1, ..., B-1 as Python's slices count. Either side may be empty:
// "10:" is everything from frame 10 on, ":50" the first fifty, ":" everything.
#pragma once

#include <optional>
#include <string_view>

namespace penumbra::slam {

struct FrameRange {
  int begin = 0;
  std::optional<int> end;  // one past the last frame; none: to the end of the sequence

  // Number of frames of a sequence of `available`. Throws InputError naming `place` for a range that is empty
  // or reaches past the end: unlike Python, nothing is cut off silently.
  int size(int available, std::string_view place) const;
};

// Throws UsageError for anything but "A:B" with non-negative whole numbers and A < B.
FrameRange parse_frame_range(std::string_view text);

}  // namespace penumbra::slam
