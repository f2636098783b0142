#include "slam/frontend/features/mismatch_filter.h"

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
  keep.reserve(h.counts.size());
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
  keep.reserve(density.size());
  for (const double d : density) keep.push_back(d >= threshold);
  return keep;
}

double distance_moved(const MatchedPixels& pair) { return (pair.first - pair.second).cast<double>().norm(); }

// Keeps or removes each of `distances` by how many there are like it.
MismatchFilterReport vote(std::vector<double> distances, MismatchFilterMode mode,
                          const MismatchFilterSettings& settings, std::vector<char>& keep) {
  std::vector<double> finite;
  finite.reserve(distances.size());
  for (const double d : distances) {
    if (std::isfinite(d)) finite.push_back(d);
  }
  MismatchFilterReport report;
  keep.assign(distances.size(), 0);
  if (finite.empty()) {
    report.removed = report.outside = static_cast<int>(distances.size());
    return report;
  }

  const int gamma = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(finite.size()))));
  const auto [least, most] = std::minmax_element(finite.begin(), finite.end());
  const double d_min = *least, d_max = *most;
  const double width = (d_max - d_min) / gamma;
  const bool by_density = mode == MismatchFilterMode::adaptive || mode == MismatchFilterMode::compensated;
  Histogram histogram;
  std::vector<char> keep_bin;
  if (mode == MismatchFilterMode::paper) {
    histogram = make_histogram(distances, 0.0, width, gamma);
    keep_bin = fullest_bins(histogram);
  } else if (by_density && finite.size() >= kFewestPairs) {
    // What is left over lies on either side of what was expected: its quartiles are -/+ the median.
    const bool two_sided = mode == MismatchFilterMode::compensated;
    const double q3 = quantile(finite, two_sided ? 0.5 : 0.75), q1 = two_sided ? -q3 : quantile(finite, 0.25);
    const double reach = settings.fence * (q3 - q1);
    const double from = two_sided ? 0.0 : std::max(d_min, q1 - reach), to = std::min(d_max, q3 + reach);
    for (double& d : distances) {
      if (d > to) d = std::numeric_limits<double>::infinity();  // outside
    }
    histogram = make_histogram(distances, from, (to - from) / gamma, gamma);
    keep_bin = dense_bins(histogram, settings.density_share);
  } else {  // nothing is removed; the bins are for the report
    histogram = make_histogram(distances, d_min, width, gamma);
    keep_bin.assign(histogram.counts.size(), 1);
  }

  report.bins.reserve(histogram.counts.size());
  for (std::size_t k = 0; k < histogram.counts.size(); ++k) {
    const double from = histogram.origin + histogram.width * static_cast<double>(k);
    report.bins.push_back({from, from + histogram.width, 0, 0});
  }
  for (std::size_t i = 0; i < distances.size(); ++i) {
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

// Pairs with an expected pixel vote on what is left over; for the others the vote on distances decides, in
// which all take part.
MismatchFilterReport vote_on_what_is_left(std::span<const MatchedPixels> pairs,
                                          const MismatchFilterSettings& settings, std::vector<char>& keep) {
  std::vector<double> moved, left_over;
  std::vector<std::size_t> expected;
  moved.reserve(pairs.size());
  left_over.reserve(pairs.size());
  expected.reserve(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const MatchedPixels& pair = pairs[i];
    moved.push_back(distance_moved(pair));
    if (!std::isfinite(moved.back()) || !pair.expected || !pair.expected->allFinite()) continue;
    expected.push_back(i);
    left_over.push_back((pair.second - *pair.expected).cast<double>().norm());
  }
  if (expected.empty()) return vote(std::move(moved), MismatchFilterMode::adaptive, settings, keep);
  std::vector<char> keep_expected;
  MismatchFilterReport report = vote(std::move(left_over), settings.mode, settings, keep_expected);
  if (expected.size() < pairs.size()) vote(std::move(moved), MismatchFilterMode::adaptive, settings, keep);
  keep.resize(pairs.size());
  for (std::size_t e = 0; e < expected.size(); ++e) keep[expected[e]] = keep_expected[e];
  report.outside += static_cast<int>(pairs.size() - expected.size());
  report.kept = static_cast<int>(std::count(keep.begin(), keep.end(), 1));
  report.removed = static_cast<int>(keep.size()) - report.kept;
  return report;
}

}  // namespace

MismatchFilterMode mismatch_filter_mode(std::string_view name) {
  for (const auto mode : {MismatchFilterMode::off, MismatchFilterMode::paper, MismatchFilterMode::adaptive,
                          MismatchFilterMode::compensated}) {
    if (name == name_of(mode)) return mode;
  }
  throw UsageError(
      fmt::format("mismatch filter: expected off, paper, adaptive or compensated, found '{}'", name));
}

std::string_view name_of(MismatchFilterMode mode) {
  switch (mode) {
    case MismatchFilterMode::paper:
      return "paper";
    case MismatchFilterMode::adaptive:
      return "adaptive";
    case MismatchFilterMode::compensated:
      return "compensated";
    default:
      return "off";
  }
}

MismatchFilterReport filter_mismatches(std::span<const MatchedPixels> pairs,
                                       const MismatchFilterSettings& settings, std::vector<char>& keep) {
  if (settings.mode == MismatchFilterMode::compensated) return vote_on_what_is_left(pairs, settings, keep);
  std::vector<double> distances;
  distances.reserve(pairs.size());
  for (const MatchedPixels& pair : pairs) distances.push_back(distance_moved(pair));
  return vote(std::move(distances), settings.mode, settings, keep);
}

}  // namespace penumbra::slam
