// Quantiles of a list of numbers. Cost: O(n), O(1) where it is sorted.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace penumbra {

// Where the quantile `q` (0..1) stands among `count` > 0 values in increasing order: between two the nearer
// one.
inline std::size_t quantile_place(std::size_t count, double q) {
  return static_cast<std::size_t>(q * static_cast<double>(count - 1) + 0.5);
}

// The value below which a share `q` (0..1) of `values` lies; 0 for no values.
inline double quantile_of(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(quantile_place(values.size(), q));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The same of values in increasing order.
inline double quantile_of_sorted(const std::vector<double>& values, double q) {
  return values.empty() ? 0.0 : values[quantile_place(values.size(), q)];
}

}  // namespace penumbra
