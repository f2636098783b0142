// A font of straight strokes for printable ASCII, made for labels and plots.
//
// A glyph lies on a grid whose unit is a sixth of a capital's height: the baseline is row 0, capitals end in
// row 6, small letters in row 4, what hangs below the line in row -2.
#pragma once

#include <string_view>

namespace penumbra {

inline constexpr int kCapitalHeight = 6;

struct Glyph {
  // Strokes, separated by blanks; a stroke is a list of points, a point a column ('0'..'4') and a row
  // ('0'..'6', 'b' for -1, 'a' for -2). A stroke of one point is a dot.
  std::string_view strokes;
  double advance;  // from where this glyph begins to where the next one does
};

// The glyph of '?' for what is not printable ASCII.
Glyph glyph_of(char letter);

inline int glyph_row(char row) { return row == 'a' ? -2 : row == 'b' ? -1 : row - '0'; }

// Calls line(from_x, from_y, to_x, to_y), rows counted upwards, for each straight part.
template <class Line>
void for_each_stroke(const Glyph& glyph, const Line& line) {
  const std::string_view s = glyph.strokes;
  for (std::size_t i = 0; i + 1 < s.size(); i += 2) {
    const bool first = i == 0 || s[i - 1] == ' ';
    const bool last = i + 2 >= s.size() || s[i + 2] == ' ';
    const int x = s[i] - '0', y = glyph_row(s[i + 1]);
    if (!first) line(s[i - 2] - '0', glyph_row(s[i - 1]), x, y);
    if (first && last) line(x, y, x, y);
    if (last) ++i;  // the blank
  }
}

}  // namespace penumbra
