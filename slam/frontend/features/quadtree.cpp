#include "slam/frontend/features/quadtree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <queue>

namespace penumbra::slam {

namespace {

struct Node {
  float x, y, width, height;  // of its region
  int begin, end;             // its corners in the array, which is kept sorted by node
  int depth;

  int size() const { return end - begin; }
};

// Corners at one and the same place cannot be separated: splitting ends here.
constexpr int kDeepest = 16;

// The four quarters of a node that hold corners; reorders the node's part of the array, stably.
std::array<Node, 4> split(const Node& node, std::vector<Corner>& corners) {
  const float w = node.width / 2, h = node.height / 2, x = node.x + w, y = node.y + h;
  const auto begin = corners.begin();
  const auto left = [x](const Corner& c) { return static_cast<float>(c.x) < x; };
  const auto upper = [y](const Corner& c) { return static_cast<float>(c.y) < y; };
  const auto row = std::stable_partition(begin + node.begin, begin + node.end, upper);
  const auto upper_column = std::stable_partition(begin + node.begin, row, left);
  const auto lower_column = std::stable_partition(row, begin + node.end, left);
  const int r = static_cast<int>(row - begin);
  return {Node{node.x, node.y, w, h, node.begin, int(upper_column - begin), node.depth + 1},
          Node{x, node.y, w, h, int(upper_column - begin), r, node.depth + 1},
          Node{node.x, y, w, h, r, int(lower_column - begin), node.depth + 1},
          Node{x, y, w, h, int(lower_column - begin), node.end, node.depth + 1}};
}

}  // namespace

std::vector<Corner> spread_corners(std::vector<Corner> corners, const Rect& region, int wanted) {
  if (wanted <= 0 || corners.empty()) return {};
  if (static_cast<int>(corners.size()) <= wanted) return corners;

  const auto left = static_cast<float>(region.x), top = static_cast<float>(region.y);
  const auto whole_width = static_cast<float>(region.width), height = static_cast<float>(region.height);
  // Start from squares side by side, so that the regions keep the shape of a square.
  const int columns = std::max(1, static_cast<int>(std::lround(whole_width / height)));
  const float width = whole_width / static_cast<float>(columns);
  const auto column_of = [&](const Corner& c) {
    return std::clamp(static_cast<int>(static_cast<float>(c.x - region.x) / width), 0, columns - 1);
  };
  std::vector<int> first(static_cast<std::size_t>(columns) + 1, 0);  // corner of each square
  for (const Corner& c : corners) ++first[static_cast<std::size_t>(column_of(c)) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<Corner> ordered(corners.size());
  std::vector<int> next = first;
  for (const Corner& c : corners) {
    int& place = next[static_cast<std::size_t>(column_of(c))];
    ordered[static_cast<std::size_t>(place++)] = c;
  }
  corners.swap(ordered);

  const auto fewer = [](const Node& a, const Node& b) {
    return a.size() != b.size() ? a.size() < b.size() : a.begin > b.begin;
  };
  std::priority_queue<Node, std::vector<Node>, decltype(fewer)> open(fewer);
  std::vector<Node> leaves;
  const auto add = [&](const Node& node) {
    if (node.size() == 0) return;
    if (node.size() == 1 || node.depth >= kDeepest) {
      leaves.push_back(node);
    } else {
      open.push(node);
    }
  };
  for (int c = 0; c < columns; ++c) {
    const auto square = static_cast<std::size_t>(c);
    add({left + static_cast<float>(c) * width, top, width, height, first[square], first[square + 1], 0});
  }
  while (!open.empty() && static_cast<int>(leaves.size() + open.size()) < wanted) {
    const Node node = open.top();
    open.pop();
    for (const Node& quarter : split(node, corners)) add(quarter);
  }
  for (; !open.empty(); open.pop()) leaves.push_back(open.top());

  std::vector<Corner> kept;
  kept.reserve(leaves.size());
  for (const Node& leaf : leaves) {
    kept.push_back(*std::max_element(corners.begin() + leaf.begin, corners.begin() + leaf.end,
                                     [](const Corner& a, const Corner& b) { return a.score < b.score; }));
  }
  return kept;
}

}  // namespace penumbra::slam
