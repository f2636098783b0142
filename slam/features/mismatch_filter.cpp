#include "slam/features/mismatch_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nn/base/error.h"

namespace penumbra::slam {

namespace {

constexpr std::size_t kFewestPairs = 8;  // for the adaptive mode
constexpr int kOutside = -1;

struct Histogram {
  double origin = 0.0, width = 0.0;  // L; with 0 everything is in bin 0
  std::vector<int> counts;           // y_k
  std::vector<int> bin_of;           // per pair; kOutside where it is in no bin
};

Histogram make_histogram(std::span<const double> distances, double origin, double width, int gamma) {
  Histogram h;
  h.origin = origin;
  h.width = width;
  h.counts.assign(static_cast<std::size_t>(gamma) + 1, 0);
  h.bin_of.reserve(distances.size());
  for (const double d : distances) {
    int bin = kOutside;
    if (std::isfinite(d)) {
      const double position = width > 0.0 ? (d - origin) / width : 0.0;
      if (position >= 0.0 && position < gamma + 1.0) bin = static_cast<int>(position);
      // The last bin is closed on both sides.
      if (position == gamma + 1.0) bin = gamma;
    }
    if (bin != kOutside) ++h.counts[static_cast<std::size_t>(bin)];
    h.bin_of.push_back(bin);
  }
  return h;
}

double quantile(std::vector<double>& values, double q) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Which bins survive.
std::vector<char> fullest_bins(const Histogram& h) {
  const int most = *std::max_element(h.counts.begin(), h.counts.end());
  std::vector<char> keep;
  for (const int y : h.counts) keep.push_back(y >= most);
  return keep;
}

std::vector<char> dense_bins(const Histogram& h, double share) {
  std::vector<double> density(h.counts.size());
  for (std::size_t k = 0; k < density.size(); ++k) {
    const int before = k > 0 ? h.counts[k - 1] : 0, after = k + 1 < density.size() ? h.counts[k + 1] : 0;
    density[k] = (before + h.counts[k] + after) / 3.0;
  }
  const double threshold = share * *std::max_element(density.begin(), density.end());
  std::vector<char> keep;
  for (const double d : density) keep.push_back(d >= threshold);
  return keep;
}

}  // namespace

MismatchFilterMode mismatch_filter_mode(std::string_view name) {
  for (const auto mode : {MismatchFilterMode::off, MismatchFilterMode::paper, MismatchFilterMode::adaptive}) {
    if (name == name_of(mode)) return mode;
  }
  throw UsageError(fmt::format("mismatch filter: expected off, paper or adaptive, found '{}'", name));
}

std::string_view name_of(MismatchFilterMode mode) {
  switch (mode) {
    case MismatchFilterMode::paper:
      return "paper";
    case MismatchFilterMode::adaptive:
      return "adaptive";
    default:
      return "off";
  }
}

MismatchFilterReport filter_mismatches(std::span<const MatchedPixels> pairs,
                                       const MismatchFilterSettings& settings, std::vector<char>& keep) {
  std::vector<double> distances, finite;
  for (const MatchedPixels& pair : pairs) {
    distances.push_back((pair.first - pair.second).cast<double>().norm());
    if (std::isfinite(distances.back())) finite.push_back(distances.back());
  }
  MismatchFilterReport report;
  keep.assign(pairs.size(), 0);
  if (finite.empty()) {
    report.removed = report.outside = static_cast<int>(pairs.size());
    return report;
  }

  const int gamma = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(finite.size()))));
  const auto [least, most] = std::minmax_element(finite.begin(), finite.end());
  const double d_min = *least, d_max = *most;
  const double width = (d_max - d_min) / gamma;
  const bool adaptive = settings.mode == MismatchFilterMode::adaptive && finite.size() >= kFewestPairs;
  Histogram histogram;
  std::vector<char> keep_bin;
  if (settings.mode == MismatchFilterMode::paper) {
    histogram = make_histogram(distances, 0.0, width, gamma);
    keep_bin = fullest_bins(histogram);
  } else if (adaptive) {
    const double q1 = quantile(finite, 0.25), q3 = quantile(finite, 0.75);
    const double reach = settings.fence * (q3 - q1);
    const double from = std::max(d_min, q1 - reach), to = std::min(d_max, q3 + reach);
    for (double& d : distances) {
      if (d > to) d = std::numeric_limits<double>::infinity();  // outside
    }
    histogram = make_histogram(distances, from, (to - from) / gamma, gamma);
    keep_bin = dense_bins(histogram, settings.density_share);
  } else {  // nothing is removed; the bins are for the report
    histogram = make_histogram(distances, d_min, width, gamma);
    keep_bin.assign(histogram.counts.size(), 1);
  }

  for (std::size_t k = 0; k < histogram.counts.size(); ++k) {
    const double from = histogram.origin + histogram.width * static_cast<double>(k);
    report.bins.push_back({from, from + histogram.width, 0, 0});
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const int bin = histogram.bin_of[i];
    const bool kept = bin != kOutside && keep_bin[static_cast<std::size_t>(bin)];
    keep[i] = kept;
    ++(kept ? report.kept : report.removed);
    if (bin != kOutside) {
      MismatchFilterReport::Bin& counted = report.bins[static_cast<std::size_t>(bin)];
      ++(kept ? counted.kept : counted.removed);
    } else {
      ++report.outside;
    }
  }
  return report;
}

}  // namespace penumbra::slam
