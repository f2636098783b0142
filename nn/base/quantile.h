// Quantiles of a list of numbers. Cost: O(n), O(1) where it is sorted.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace penumbra {

// The value below which a share `q` (0..1) of `values` lies, between two the nearer one; 0 for no values.
inline double quantile_of(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The same of values in increasing order, of which there must be some; between two it is the lower one.
inline double quantile_of_sorted(const std::vector<double>& values, double q) {
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

}  // namespace penumbra
