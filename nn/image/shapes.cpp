#include "nn/image/shapes.h"

#include <algorithm>
#include <climits>
#include <cstdlib>
#include <utility>

#include "nn/image/set_bytes.h"

namespace penumbra {

namespace {

// Columns first to last of a row, cut to the mask.
void fill_span(ByteImage& mask, int y, int first, int last, std::uint8_t value) {
  if (y < 0 || y >= mask.height()) return;
  first = std::max(first, 0);
  last = std::min(last, mask.width() - 1);
  if (first <= last) std::fill_n(mask.row(y) + first, last - first + 1, value);
}

// A line of pixels that touch at sides or corners, from left to right: Bresenham's.
void draw_thin_line(ByteImage& mask, Pixel a, Pixel b, std::uint8_t value) {
  if (b.x < a.x) std::swap(a, b);
  const int dx = b.x - a.x, dy = std::abs(b.y - a.y), down = b.y < a.y ? -1 : 1;
  const int most = std::max(dx, dy), least = std::min(dx, dy);
  int error = most - 2 * least;
  for (int i = 0; i <= most; ++i) {
    fill_span(mask, a.y, a.x, a.x, value);
    const bool diagonal = error < 0;
    error += (diagonal ? 2 * most : 0) - 2 * least;
    if (dx >= dy || diagonal) ++a.x;
    if (dx < dy || diagonal) a.y += down;
  }
}

// Twice the area of the triangle; positive where c lies to the left of a -> b, y upwards.
long turn(const Pixel& a, const Pixel& b, const Pixel& c) {
  return static_cast<long>(b.x - a.x) * (c.y - a.y) - static_cast<long>(b.y - a.y) * (c.x - a.x);
}

// Pixels begin <= column < end of a row, and the group that they belong to.
struct Run {
  int begin, end;
  std::int32_t group;
};
constexpr std::int32_t kNoGroup = -1;

// Calls visit(begin, end) for every run of pixels that are not 0, from left to right.
template <typename Visit>
void find_runs(const std::uint8_t* row, int width, Visit&& visit) {
  int x = 0;
  while (x < width) {
    const int begin = x = next_set_byte(row, x, width);
    while (x < width && row[x] != 0) ++x;
    if (begin < x) visit(begin, x);
  }
}

// Groups of which some turn out to be one (union-find).
class Groups {
 public:
  int add() {
    parent_.push_back(static_cast<std::int32_t>(parent_.size()));
    return parent_.back();
  }
  std::int32_t root(std::int32_t i) {
    while (parent_[std::size_t(i)] != i)
      i = parent_[std::size_t(i)] = parent_[std::size_t(parent_[std::size_t(i)])];
    return i;
  }
  std::int32_t join(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    return parent_[std::size_t(std::max(a, b))] = std::min(a, b);
  }
  std::size_t size() const { return parent_.size(); }

 private:
  std::vector<std::int32_t> parent_;
};

}  // namespace

void fill_disc(ByteImage& mask, const Pixel& centre, int radius, std::uint8_t value) {
  // One eighth of the circle, from the row through the centre to the diagonal; each step is four rows' spans.
  int dx = radius, dy = 0, error = 0, plus = 1, minus = 2 * radius - 1;
  while (dx >= dy) {
    for (const int sign : {-1, 1}) {
      fill_span(mask, centre.y + sign * dy, centre.x - dx, centre.x + dx, value);
      fill_span(mask, centre.y + sign * dx, centre.x - dy, centre.x + dy, value);
    }
    ++dy;
    error += plus;
    plus += 2;
    if (error > 0) {
      error -= minus;
      --dx;
      minus -= 2;
    }
  }
}

int connected_components(const ByteView& mask, Image<std::int32_t>& labels) {
  // A part is made of runs, and a run of a row's pixels that are not 0, side by side.
  std::vector<Run> runs;
  std::vector<std::size_t> first(1, 0);  // run of each row; one more at the end
  Groups groups;
  for (int y = 0; y < mask.height; ++y) {
    std::size_t above = y > 0 ? first[static_cast<std::size_t>(y) - 1] : 0;
    const std::size_t above_end = first.back();
    find_runs(mask.row(y), mask.width, [&](int begin, int end) {
      std::int32_t group = kNoGroup;
      // Those of the row above that it touches: the last of them may touch the next run, too.
      while (above < above_end && runs[above].end < begin) ++above;
      for (std::size_t i = above; i < above_end && runs[i].begin <= end; ++i)
        group = group == kNoGroup ? runs[i].group : groups.join(group, runs[i].group);
      runs.push_back({begin, end, group == kNoGroup ? groups.add() : group});
    });
    first.push_back(runs.size());
  }
  // Two rows at a time, two columns before the next two: the order of the blocks.
  std::vector<std::int32_t> number(groups.size(), 0);
  int count = 0;
  const auto meet = [&](Run& run) {
    std::int32_t& n = number[static_cast<std::size_t>(groups.root(run.group))];
    if (n == 0) n = ++count;
    run.group = n;
  };
  for (std::size_t y = 0; y + 1 < first.size(); y += 2) {
    const std::size_t last = std::min(y + 2, first.size() - 1);
    std::size_t upper = first[y], lower = first[y + 1];
    while (upper < first[y + 1] || lower < first[last]) {
      const bool takes_upper =
          lower >= first[last] || (upper < first[y + 1] && runs[upper].begin / 2 <= runs[lower].begin / 2);
      meet(runs[takes_upper ? upper++ : lower++]);
    }
  }
  labels.create(mask.width, mask.height);
  labels.fill(0);
  for (std::size_t y = 0; y + 1 < first.size(); ++y) {
    std::int32_t* row = labels.row(static_cast<int>(y));
    for (std::size_t i = first[y]; i < first[y + 1]; ++i)
      std::fill(row + runs[i].begin, row + runs[i].end, runs[i].group);
  }
  return count;
}

std::vector<Pixel> convex_hull(std::vector<Pixel> points) {
  std::sort(points.begin(), points.end(),
            [](const Pixel& a, const Pixel& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Pixel> hull;
  const auto add_chain = [&](auto begin, auto end) {
    const std::size_t first = hull.size();
    for (auto p = begin; p != end; ++p) {
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), *p) <= 0) hull.pop_back();
      hull.push_back(*p);
    }
    hull.pop_back();  // where the other one begins
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return hull;
}

void fill_convex(ByteImage& mask, std::span<const Pixel> corners, std::uint8_t value) {
  if (corners.empty()) return;
  const auto [highest, lowest] = std::minmax_element(
      corners.begin(), corners.end(), [](const Pixel& a, const Pixel& b) { return a.y < b.y; });
  const int top = highest->y, rows = lowest->y - top + 1;
  // Per row the outermost columns that a side reaches, in 65536ths.
  constexpr long kOne = 65536;
  std::vector<std::pair<long, long>> spans(static_cast<std::size_t>(rows), {LONG_MAX, LONG_MIN});
  const auto reach = [&](int y, long x) {
    auto& [first, last] = spans[static_cast<std::size_t>(y - top)];
    first = std::min(first, x);
    last = std::max(last, x);
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    Pixel a = corners[i], b = corners[(i + 1) % corners.size()];
    draw_thin_line(mask, a, b, value);
    if (corners.size() < 3) continue;  // nothing lies between
    if (b.y < a.y) std::swap(a, b);
    if (a.y == b.y) continue;
    // Halves away from zero, the step rounded once and added row by row.
    const long height = b.y - a.y, twice = 2 * (b.x - a.x) * kOne;
    const long step = (twice + height) / (2 * height);
    long x = a.x * kOne;
    for (int y = a.y; y <= b.y; ++y, x += step) reach(y, x);
  }
  for (int y = 0; y < rows; ++y) {
    const auto& [first, last] = spans[static_cast<std::size_t>(y)];
    if (first > last) continue;
    fill_span(mask, top + y, static_cast<int>((first + kOne / 2) >> 16),
              static_cast<int>((last + kOne / 2) >> 16), value);
  }
}

Rect bounds_of(const ByteView& mask) {
  int left = mask.width, right = -1, top = mask.height, bottom = -1;
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      if (mask.at(x, y) == 0) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::min(top, y);
      bottom = y;
    }
  }
  return right < 0 ? Rect{} : Rect{left, top, right - left + 1, bottom - top + 1};
}

int count_pixels(const ByteView& mask) {
  int count = 0;
  for (int y = 0; y < mask.height; ++y) {
    const std::uint8_t* row = mask.row(y);
    for (int x = 0; x < mask.width; ++x) count += row[x] != 0;
  }
  return count;
}

}  // namespace penumbra
