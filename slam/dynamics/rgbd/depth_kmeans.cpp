#include "slam/dynamics/rgbd/depth_kmeans.h"

#include <algorithm>

namespace penumbra::slam {

namespace {

constexpr int kMostIterations = 50;

}  // namespace

void DepthHistogram::clear() {
  counts_.fill(0);
  sums_.fill(0.0);
}

const std::vector<DepthCluster>& DepthKmeans::cluster(const DepthHistogram& histogram, int k) {
  bins_.clear();
  counts_.assign(1, 0);
  sums_.assign(1, 0.0);
  clusters_.clear();
  for (int bin = 0; bin < DepthHistogram::kBins; ++bin) {
    const int count = histogram.count(bin);
    if (count == 0) continue;
    const double mean = histogram.mean(bin);
    bins_.push_back({bin, mean});
    counts_.push_back(counts_.back() + count);
    sums_.push_back(sums_.back() + mean * count);
  }
  if (bins_.empty() || k < 1) return clusters_;
  centres_.clear();
  for (int j = 0; j < k; ++j) {
    const double rank = (j + 0.5) / k * counts_.back();
    const auto after = std::upper_bound(counts_.begin() + 1, counts_.end() - 1, rank);
    const double centre = bins_[static_cast<std::size_t>(after - counts_.begin()) - 1].mean;
    if (centres_.empty() || centre > centres_.back()) centres_.push_back(centre);
  }
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    clusters_.clear();
    std::size_t begin = 0;
    for (std::size_t j = 0; j < centres_.size(); ++j) {
      std::size_t end = bins_.size();
      if (j + 1 < centres_.size()) {
        const double middle = 0.5 * (centres_[j] + centres_[j + 1]);
        const auto at = std::upper_bound(bins_.begin() + static_cast<std::ptrdiff_t>(begin), bins_.end(),
                                         middle, [](double z, const Bin& bin) { return z < bin.mean; });
        end = static_cast<std::size_t>(at - bins_.begin());
      }
      if (end == begin) continue;
      const int count = counts_[end] - counts_[begin];
      clusters_.push_back(
          {(sums_[end] - sums_[begin]) / count, count, bins_[begin].number, bins_[end - 1].number});
      begin = end;
    }
    bool changed = clusters_.size() != centres_.size();
    for (std::size_t j = 0; !changed && j < clusters_.size(); ++j) changed = clusters_[j].mean != centres_[j];
    if (!changed) break;
    centres_.clear();
    for (const DepthCluster& cluster : clusters_) centres_.push_back(cluster.mean);
  }
  return clusters_;
}

}  // namespace penumbra::slam
