#include "slam/evaluation/statistics.h"

#include <algorithm>
#include <cmath>

namespace penumbra::slam {

ErrorStatistics error_statistics(std::vector<double> errors) {
  ErrorStatistics statistics;
  if (errors.empty()) return statistics;
  std::sort(errors.begin(), errors.end());
  const auto n = static_cast<double>(errors.size());
  double sum = 0.0;
  for (const double error : errors) {
    sum += error;
    statistics.sse += error * error;
  }
  statistics.count = static_cast<int>(errors.size());
  statistics.mean = sum / n;
  statistics.rmse = std::sqrt(statistics.sse / n);
  double squared_deviations = 0.0;
  for (const double error : errors) squared_deviations += std::pow(error - statistics.mean, 2);
  statistics.std = std::sqrt(squared_deviations / n);
  const std::size_t middle = errors.size() / 2;
  statistics.median = errors.size() % 2 == 1 ? errors[middle] : 0.5 * (errors[middle - 1] + errors[middle]);
  statistics.min = errors.front();
  statistics.max = errors.back();
  return statistics;
}

}  // namespace penumbra::slam
