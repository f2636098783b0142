// Finds the keyframes that show the same place as an image, by their descriptors alone and without a trained
// vocabulary.
//
// Binary search trees over the descriptors' bits. An inner node tests one bit, a leaf holds up to
// `leaf_size` descriptors; a leaf that overflows is split on the bit, unused on its path, that comes nearest
// to parting it in halves. A query descriptor walks down to one leaf and is compared there with all:
// the nearest and those hardly farther match. A noisy bit on the way down misses a match: several trees, each
// of which knows only its own share of the bits, miss independently.
//
//   w(d) = log(1 + N / n_d)            n_d: keyframes of N that descriptor d of the image matches (idf)
//   score(k) = sum of w(d) over the image's descriptors that match one of keyframe k, divided by the square
//              root of the number of k's descriptors
//   place(k) = sum of score over k and the keyframes covisible with it, each once
//
// Candidates are the best keyframes of the best places. An appearance alone proves nothing: verify them.
//
// Memory: 8 bytes a descriptor and tree; descriptors stay in the keyframes' features. Cost of a query: about
// 1 ms for 1000 descriptors. Insertion order decides the trees; nothing else does: results repeat. Changes
// need Map::mutex() alone, queries shared.
// Source: Schlegel, Grisetti, HBST: A Hamming Distance Embedding Binary Search Tree for Visual Place
// Recognition (RA-L 2018); weights: Sivic, Zisserman, Video Google (ICCV 2003).
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "slam/map/map.h"

namespace penumbra::slam {

struct PlaceIndexSettings {
  int trees = 2;
  int leaf_size = 64;      // descriptors
  int max_distance = 40;   // Hamming, of descriptors that count as a match ...
  int margin = 3;          // ... and how much farther than the nearest one they may be
  int fewest_matches = 6;  // descriptors in which a candidate must match
};

// A keyframe that may show the same place.
struct PlaceCandidate {
  KeyFrame* keyframe = nullptr;
  double score = 0.0;  // place(k)
  int matches = 0;     // descriptors of the image that match one of the keyframe's
};

class PlaceIndex {
 public:
  explicit PlaceIndex(const PlaceIndexSettings& settings = {});

  // Indexes the features that show map points. A keyframe that is in already, or shows no point, changes
  // nothing.
  void insert(KeyFrame* keyframe);
  // Indexes the keyframes of a map that was loaded: what its index was.
  void insert_all(const Map& map);
  // Forgets the keyframes that the map has erased. Queries skip them before that.
  void remove_erased();

  // The best keyframes of the `most` best places, best first; `excluded` keyframes take no part.
  std::vector<PlaceCandidate> query(const FeatureView& features, int most,
                                    const std::function<bool(const KeyFrame&)>& excluded = {}) const;

  int keyframes() const { return alive_; }
  std::size_t descriptors() const;
  std::size_t bytes() const;  // of the trees

 private:
  struct Entry {
    int keyframe = 0;  // place in keyframes_
    int feature = 0;
  };
  struct Node {
    int bit = -1;                // that is tested; -1: a leaf
    int children[2] = {-1, -1};  // bit clear, bit set
    int unsplittable_until = 0;  // entries up to which no bit parts the leaf
    std::vector<Entry> entries;
  };
  struct Indexed {
    KeyFrame* keyframe = nullptr;
    std::shared_ptr<const FrameFeatures> features;  // kept until the entries are removed
    std::vector<int> entries;                       // features
  };
  using Tree = std::vector<Node>;  // root first

  const Descriptor& descriptor(const Entry& entry) const;
  int leaf_of(const Tree& tree, const Descriptor& descriptor) const;
  void insert(int tree, const Entry& entry);
  void split(int tree, int leaf);
  std::array<int, kDescriptorBits> count_bits(const std::vector<Entry>& entries) const;
  int balanced_bit(int tree, int leaf) const;

  PlaceIndexSettings settings_;
  std::vector<Tree> trees_;
  std::vector<std::vector<char>> bit_of_tree_;  // tree, bit: whether the tree may test it
  std::vector<Indexed> keyframes_;              // in the order of insertion
  std::vector<int> slot_of_;                    // keyframe id -> place in keyframes_; -1: not indexed
  int alive_ = 0;
};

}  // namespace penumbra::slam
