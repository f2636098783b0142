// K-means of depths, over a histogram instead of over pixels.
//
// Bins are steps of 1/z of 1/512 per metre (a Kinect's own steps are 1/345 to 1/350): 2 mm at 1 m, 18 mm at
// 3 m. A bin remembers how many depths it has and their sum, so that means are those of the depths
// themselves; all of a bin go to one cluster. In one dimension clusters are intervals, parted at the middles
// of their centres: with the bins in order of depth and their running sums, an iteration of Lloyd's costs k
// binary searches.
//
//   start   c_j = quantile (j + 1/2) / k of the depths
//   repeat  b_j = (c_j + c_j+1) / 2,   c_j = mean of the depths between b_j-1 and b_j      until none changes
//
// Clusters that lose all of their depths are left out. Over pixels the result is the same but for depths in a
// bin that a middle cuts. Cost: a count a depth, then about 5 us.
// Source: Lloyd, Least squares quantization in PCM (1982).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace penumbra::slam {

class DepthHistogram {
 public:
  static constexpr int kBins = 2048;
  static constexpr float kBinsPerInverse =
      512.0F;  // bins a 1/metre: the last holds all that is nearer than 1/4 m

  // Of a depth above 0, finite. Nearer ones have lower numbers.
  static int bin_of(float metres) {
    const float inverse = kBinsPerInverse / metres;
    return kBins - 1 - (inverse < static_cast<float>(kBins - 1) ? static_cast<int>(inverse) : kBins - 1);
  }
  // The farthest depth of a bin.
  static double depth_of(int bin) {
    return static_cast<double>(kBinsPerInverse) / std::max(0.5, kBins - 1.0 - bin);
  }
  void clear();
  void add(float metres) {
    const auto bin = static_cast<std::size_t>(bin_of(metres));
    ++counts_[bin];
    sums_[bin] += static_cast<double>(metres);
  }
  int count(int bin) const { return counts_[static_cast<std::size_t>(bin)]; }
  // Of the depths of a bin that has some.
  double mean(int bin) const {
    return sums_[static_cast<std::size_t>(bin)] / counts_[static_cast<std::size_t>(bin)];
  }

 private:
  std::array<std::int32_t, kBins> counts_{};
  std::array<double, kBins> sums_{};
};

// Depths of the bins first, first + 1, ..., last.
struct DepthCluster {
  double mean = 0.0;  // metres
  int count = 0;
  int first = 0, last = 0;
};

// Keeps its memory; for one thread at a time.
class DepthKmeans {
 public:
  // At most `k` clusters, the nearest first; none for an empty histogram. Valid until the next call.
  const std::vector<DepthCluster>& cluster(const DepthHistogram& histogram, int k);

 private:
  struct Bin {
    int number = 0;
    double mean = 0.0;
  };
  std::vector<Bin> bins_;  // that have depths
  std::vector<int> counts_;
  std::vector<double> sums_;  // of all bins before
  std::vector<double> centres_;
  std::vector<DepthCluster> clusters_;
};

}  // namespace penumbra::slam
