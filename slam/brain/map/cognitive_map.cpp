#include "slam/brain/map/cognitive_map.h"

#include <algorithm>

#include "nn/base/error.h"

namespace penumbra::slam::brain {

int CognitiveMap::add(Node node) {
  nodes_.push_back(std::move(node));
  links_of_.emplace_back();
  return size() - 1;
}

void CognitiveMap::add(const Link& link) {
  const auto is_node = [&](int i) { return i >= 0 && i < size(); };
  if (!is_node(link.from) || !is_node(link.to) || link.from == link.to) {
    throw UsageError(
        fmt::format("link: expected two of {} nodes, found {} and {}", size(), link.from, link.to));
  }
  for (const int end : {link.from, link.to})
    links_of_[static_cast<std::size_t>(end)].push_back(static_cast<int>(links_.size()));
  links_.push_back(link);
}

int CognitiveMap::hops(int from, int to, int most) const {
  std::vector<int> reached{from}, next;
  std::vector<int> seen{from};
  for (int hops = 0; hops <= most; ++hops) {
    if (std::find(reached.begin(), reached.end(), to) != reached.end()) return hops;
    next.clear();
    for (const int node : reached) {
      for (const int l : links_of(node)) {
        const Link& link = links_[static_cast<std::size_t>(l)];
        const int other = link.from == node ? link.to : link.from;
        if (std::find(seen.begin(), seen.end(), other) != seen.end()) continue;
        seen.push_back(other);
        next.push_back(other);
      }
    }
    std::swap(reached, next);
  }
  return most + 1;
}

std::size_t CognitiveMap::bytes() const {
  std::size_t bytes = links_.size() * (sizeof(Link) + 2 * sizeof(int));
  for (const Node& node : nodes_) {
    bytes += sizeof(Node) + node.activity.size() * sizeof(float) + node.points.size() * sizeof(PlacePoint) +
             sizeof(std::vector<int>);
  }
  return bytes;
}

}  // namespace penumbra::slam::brain
