#include "slam/frontend/features/quadtree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace penumbra::slam {

namespace {

// Corners at one and the same place cannot be separated: splitting ends here.
constexpr int kDeepest = 16;

}  // namespace

const std::vector<Corner>& CornerSpreader::spread(const std::vector<Corner>& corners, const Rect& region,
                                                  int wanted) {
  kept_.clear();
  if (wanted <= 0) return kept_;
  if (static_cast<int>(corners.size()) <= wanted) return corners;
  begin(corners, region);
  while (!open_.empty() && static_cast<int>(leaves_.size() + open_.size()) < wanted) {
    const Node node = open_.front();
    std::pop_heap(open_.begin(), open_.end(), is_smaller);
    open_.pop_back();
    split(node);
  }
  std::sort_heap(open_.begin(), open_.end(), is_smaller);
  leaves_.insert(leaves_.end(), open_.rbegin(), open_.rend());
  kept_.reserve(leaves_.size());
  for (const Node& leaf : leaves_) {
    kept_.push_back(*std::max_element(corners_.begin() + leaf.begin, corners_.begin() + leaf.end,
                                      [](const Corner& a, const Corner& b) { return a.score < b.score; }));
  }
  return kept_;
}

// Starts from squares side by side, so that the regions keep the shape of a square.
void CornerSpreader::begin(const std::vector<Corner>& corners, const Rect& region) {
  const auto left = static_cast<float>(region.x), top = static_cast<float>(region.y);
  const auto whole_width = static_cast<float>(region.width), height = static_cast<float>(region.height);
  const int columns = std::max(1, static_cast<int>(std::lround(whole_width / height)));
  const float width = whole_width / static_cast<float>(columns);
  const auto column_of = [&](const Corner& c) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>(static_cast<float>(c.x - region.x) / width), 0, columns - 1));
  };
  square_.assign(static_cast<std::size_t>(columns) + 2, 0);
  for (const Corner& c : corners) ++square_[column_of(c) + 2];
  std::partial_sum(square_.begin(), square_.end(), square_.begin());
  corners_.resize(corners.size());
  part_.resize(corners.size());
  // Moves the begin of each square's corners to its end, which is the next one's begin.
  for (const Corner& c : corners) corners_[static_cast<std::size_t>(square_[column_of(c) + 1]++)] = c;
  open_.clear();
  leaves_.clear();
  for (int c = 0; c < columns; ++c) {
    const auto square = static_cast<std::size_t>(c);
    add({left + static_cast<float>(c) * width, top, width, height, square_[square], square_[square + 1], 0});
  }
}

void CornerSpreader::add(const Node& node) {
  if (node.size() == 0) return;
  if (node.size() == 1 || node.depth >= kDeepest) {
    leaves_.push_back(node);
    return;
  }
  open_.push_back(node);
  std::push_heap(open_.begin(), open_.end(), is_smaller);
}

// Into the four quarters that hold corners, which stay in their order within each.
void CornerSpreader::split(const Node& node) {
  const float w = node.width / 2, h = node.height / 2, x = node.x + w, y = node.y + h;
  const auto quarter_of = [&](const Corner& c) {
    return 2U * (static_cast<float>(c.y) >= y) + (static_cast<float>(c.x) >= x);
  };
  const auto first = corners_.begin() + node.begin, last = corners_.begin() + node.end;
  std::array<int, 5> begin{};  // of each quarter; the node's end
  for (auto c = first; c != last; ++c) ++begin[quarter_of(*c) + 1];
  begin[0] = node.begin;
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::array<int, 5> next = begin;
  std::copy(first, last, part_.begin());
  for (auto c = part_.begin(); c != part_.begin() + node.size(); ++c)
    corners_[static_cast<std::size_t>(next[quarter_of(*c)]++)] = *c;
  const std::array<std::array<float, 2>, 4> corner = {{{node.x, node.y}, {x, node.y}, {node.x, y}, {x, y}}};
  for (std::size_t q = 0; q < corner.size(); ++q)
    add({corner[q][0], corner[q][1], w, h, begin[q], begin[q + 1], node.depth + 1});
}

}  // namespace penumbra::slam
