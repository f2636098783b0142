#include "slam/place/place_index.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "nn/base/counter_random.h"

namespace penumbra::slam {

namespace {

// A bit parts a leaf well enough if each side gets at least this share.
constexpr double kLeastShare = 0.25;

bool bit_of(const Descriptor& descriptor, int bit) {
  return (descriptor[static_cast<std::size_t>(bit) / 64] >> (static_cast<unsigned>(bit) % 64U)) & 1U;
}

// Bit i of a byte as the lowest of byte i.
std::uint64_t spread_bits(std::uint64_t byte) {
  constexpr std::uint64_t kEverywhere = 0x0101010101010101, kOneEach = 0x8040201008040201;
  const std::uint64_t own = (byte * kEverywhere) & kOneEach;  // bit i in byte i
  return ((own + 0x7F7F7F7F7F7F7F7F) | own) >> 7 & kEverywhere;
}

}  // namespace

PlaceIndex::PlaceIndex(const PlaceIndexSettings& settings) : settings_(settings) {
  settings_.trees = std::max(1, settings_.trees);
  const std::size_t trees = static_cast<std::size_t>(settings_.trees);
  trees_.assign(trees, Tree(1));
  bit_of_tree_.assign(trees, std::vector<char>(kDescriptorBits, 0));
  // The bits are dealt out in an order that repeats but has nothing to do with the pattern.
  std::array<int, kDescriptorBits> order{};
  for (int b = 0; b < kDescriptorBits; ++b) order[static_cast<std::size_t>(b)] = b;
  for (std::size_t b = kDescriptorBits - 1; b > 0; --b) {
    std::swap(order[b], order[counter_random(7, b) % (b + 1)]);
  }
  for (std::size_t b = 0; b < kDescriptorBits; ++b) {
    bit_of_tree_[b % trees][static_cast<std::size_t>(order[b])] = 1;
  }
}

const Descriptor& PlaceIndex::descriptor(const Entry& entry) const {
  return keyframes_[static_cast<std::size_t>(entry.keyframe)].features->descriptor(entry.feature);
}

int PlaceIndex::leaf_of(const Tree& tree, const Descriptor& descriptor) const {
  int at = 0;
  while (tree[static_cast<std::size_t>(at)].bit >= 0) {
    const Node& node = tree[static_cast<std::size_t>(at)];
    at = node.children[bit_of(descriptor, node.bit) ? 1 : 0];
  }
  return at;
}

void PlaceIndex::insert(KeyFrame* keyframe) {
  const std::size_t id = static_cast<std::size_t>(keyframe->id);
  if (keyframe->erased || (id < slot_of_.size() && slot_of_[id] >= 0)) return;
  Indexed indexed{keyframe, keyframe->features, {}};
  for (int i = 0; i < keyframe->features->size(); ++i) {
    if (keyframe->points[static_cast<std::size_t>(i)] != nullptr) indexed.entries.push_back(i);
  }
  if (indexed.entries.empty()) return;
  const int slot = static_cast<int>(keyframes_.size());
  if (slot_of_.size() <= id) slot_of_.resize(id + 1, -1);
  slot_of_[id] = slot;
  keyframes_.push_back(std::move(indexed));
  ++alive_;
  for (int tree = 0; tree < settings_.trees; ++tree) {
    for (const int feature : keyframes_.back().entries) insert(tree, {slot, feature});
  }
}

void PlaceIndex::insert_all(const Map& map) {
  for (KeyFrame* keyframe : map.keyframes()) insert(keyframe);
}

void PlaceIndex::insert(int tree, const Entry& entry) {
  Tree& nodes = trees_[static_cast<std::size_t>(tree)];
  const int leaf = leaf_of(nodes, descriptor(entry));
  Node& node = nodes[static_cast<std::size_t>(leaf)];
  node.entries.push_back(entry);
  const int size = static_cast<int>(node.entries.size());
  if (size > settings_.leaf_size && size > node.unsplittable_until) split(tree, leaf);
}

// How many of the entries have each bit set.
std::array<int, kDescriptorBits> PlaceIndex::count_bits(const std::vector<Entry>& entries) const {
  // Eight bits at a time: a byte's bits, each in a byte of its own, are added up in a word of eight counts.
  constexpr std::size_t kBytes = kDescriptorBits / 8, kMostAtOnce = 255;
  std::array<int, kDescriptorBits> set{};
  for (std::size_t begin = 0; begin < entries.size(); begin += kMostAtOnce) {
    std::array<std::uint64_t, kBytes> counts{};
    for (std::size_t i = begin; i < std::min(begin + kMostAtOnce, entries.size()); ++i) {
      const Descriptor& d = descriptor(entries[i]);
      for (std::size_t b = 0; b < kBytes; ++b) counts[b] += spread_bits((d[b / 8] >> (8 * (b % 8))) & 0xFF);
    }
    for (std::size_t bit = 0; bit < kDescriptorBits; ++bit)
      set[bit] += static_cast<int>((counts[bit / 8] >> (8 * (bit % 8))) & 0xFF);
  }
  return set;
}

// The bit that parts the leaf most evenly; -1 where none does so well enough.
int PlaceIndex::balanced_bit(int tree, int leaf) const {
  const Node& node = trees_[static_cast<std::size_t>(tree)][static_cast<std::size_t>(leaf)];
  const std::array<int, kDescriptorBits> set = count_bits(node.entries);
  // A bit that was tested on the path is equal in all entries, and so never chosen.
  const int size = static_cast<int>(node.entries.size());
  int best = -1, best_smaller_side = static_cast<int>(kLeastShare * size) - 1;
  for (int b = 0; b < kDescriptorBits; ++b) {
    if (!bit_of_tree_[static_cast<std::size_t>(tree)][static_cast<std::size_t>(b)]) continue;
    const int ones = set[static_cast<std::size_t>(b)];
    const int smaller_side = std::min(ones, size - ones);
    if (smaller_side > best_smaller_side) {
      best_smaller_side = smaller_side;
      best = b;
    }
  }
  return best;
}

void PlaceIndex::split(int tree, int leaf) {
  Tree& nodes = trees_[static_cast<std::size_t>(tree)];
  const int bit = balanced_bit(tree, leaf);
  Node& parent = nodes[static_cast<std::size_t>(leaf)];
  if (bit < 0) {  // tried again when the leaf has doubled
    parent.unsplittable_until = 2 * static_cast<int>(parent.entries.size());
    return;
  }
  std::array<Node, 2> children;
  for (const Entry& entry : parent.entries) {
    children[bit_of(descriptor(entry), bit) ? 1 : 0].entries.push_back(entry);
  }
  parent.bit = bit;
  parent.entries = {};
  for (std::size_t side = 0; side < 2; ++side) {
    parent.children[side] = static_cast<int>(nodes.size() + side);
  }
  nodes.push_back(std::move(children[0]));
  nodes.push_back(std::move(children[1]));
}

void PlaceIndex::remove_erased() {
  for (std::size_t slot = 0; slot < keyframes_.size(); ++slot) {
    Indexed& indexed = keyframes_[slot];
    if (indexed.features == nullptr || !indexed.keyframe->erased) continue;
    for (Tree& tree : trees_) {
      for (const int feature : indexed.entries) {
        const int leaf = leaf_of(tree, indexed.features->descriptor(feature));
        std::erase_if(tree[static_cast<std::size_t>(leaf)].entries,
                      [&](const Entry& e) { return e.keyframe == static_cast<int>(slot); });
      }
    }
    indexed.features.reset();
    indexed.entries = {};
    --alive_;
  }
}

std::vector<PlaceCandidate> PlaceIndex::query(const FeatureView& features, int most,
                                              const std::function<bool(const KeyFrame&)>& excluded) const {
  const std::size_t slots = keyframes_.size();
  std::vector<char> open(slots, 0);
  int open_keyframes = 0;
  for (std::size_t s = 0; s < slots; ++s) {
    const KeyFrame& keyframe = *keyframes_[s].keyframe;
    open[s] = !keyframe.erased && !(excluded && excluded(keyframe));
    open_keyframes += open[s];
  }
  std::vector<double> score(slots, 0.0);
  std::vector<int> matches(slots, 0), matched_by(slots, -1), matched;
  std::vector<std::pair<int, int>> near;  // distance, keyframe
  for (int i = 0; i < features.size(); ++i) {
    if (features.is_movable(i)) continue;
    matched.clear();
    near.clear();
    int nearest = settings_.max_distance - settings_.margin;
    for (const Tree& tree : trees_) {
      const int leaf = leaf_of(tree, features.descriptor(i));
      for (const Entry& entry : tree[static_cast<std::size_t>(leaf)].entries) {
        if (!open[static_cast<std::size_t>(entry.keyframe)]) continue;
        const int distance = hamming_distance(features.descriptor(i), descriptor(entry));
        if (distance > nearest + settings_.margin) continue;
        near.emplace_back(distance, entry.keyframe);
        nearest = std::min(nearest, distance);
      }
    }
    for (const auto& [distance, keyframe] : near) {
      const std::size_t s = static_cast<std::size_t>(keyframe);
      if (distance > nearest + settings_.margin || matched_by[s] == i) continue;
      matched_by[s] = i;
      matched.push_back(keyframe);
    }
    if (matched.empty()) continue;
    const double weight =
        std::log(1.0 + static_cast<double>(open_keyframes) / static_cast<double>(matched.size()));
    for (const int s : matched) {
      score[static_cast<std::size_t>(s)] += weight;
      ++matches[static_cast<std::size_t>(s)];
    }
  }
  for (std::size_t s = 0; s < slots; ++s) {
    if (matches[s] > 0) score[s] /= std::sqrt(static_cast<double>(keyframes_[s].entries.size()));
  }

  // Neighbours show the same place and share its votes.
  const auto slot_of = [&](const KeyFrame& keyframe) {
    const std::size_t id = static_cast<std::size_t>(keyframe.id);
    return id < slot_of_.size() ? slot_of_[id] : -1;
  };
  struct Place {
    PlaceCandidate candidate;
    std::size_t slot;
  };
  std::vector<Place> places;
  for (std::size_t s = 0; s < slots; ++s) {
    if (matches[s] < settings_.fewest_matches) continue;
    double sum = score[s];
    for (const Covisible& c : keyframes_[s].keyframe->covisibles) {
      const int neighbour = slot_of(*c.keyframe);
      if (neighbour >= 0) sum += score[static_cast<std::size_t>(neighbour)];
    }
    places.push_back({{keyframes_[s].keyframe, sum, matches[s]}, s});
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.candidate.score > b.candidate.score; });

  // One keyframe a place: the best of those around the place's centre.
  std::vector<PlaceCandidate> candidates;
  std::vector<char> covered(slots, 0);
  for (const Place& place : places) {
    if (static_cast<int>(candidates.size()) >= most) break;
    if (covered[place.slot]) continue;
    std::size_t best = place.slot;
    covered[place.slot] = 1;
    for (const Covisible& c : place.candidate.keyframe->covisibles) {
      const int neighbour = slot_of(*c.keyframe);
      if (neighbour < 0) continue;
      const std::size_t n = static_cast<std::size_t>(neighbour);
      covered[n] = 1;
      if (open[n] && score[n] > score[best]) best = n;
    }
    candidates.push_back({keyframes_[best].keyframe, place.candidate.score, matches[best]});
  }
  return candidates;
}

std::size_t PlaceIndex::descriptors() const {
  std::size_t count = 0;
  for (const Indexed& indexed : keyframes_) count += indexed.entries.size();
  return count;
}

std::size_t PlaceIndex::bytes() const {
  std::size_t sum = 0;
  for (const Tree& tree : trees_) {
    sum += tree.capacity() * sizeof(Node);
    for (const Node& node : tree) sum += node.entries.capacity() * sizeof(Entry);
  }
  return sum;
}

}  // namespace penumbra::slam
