// Summary of a list of errors e_1..e_n, the numbers that evo prints:
//
//   rmse = sqrt(1/n sum e^2)   mean = 1/n sum e   std = sqrt(1/n sum (e - mean)^2)   sse = sum e^2
//   median: the middle value, for even n the mean of the two middle ones
#pragma once

#include <vector>

namespace penumbra::slam {

struct ErrorStatistics {
  int count = 0;  // where it is 0, all others are 0 and mean nothing
  double rmse = 0.0, mean = 0.0, median = 0.0, std = 0.0, min = 0.0, max = 0.0, sse = 0.0;
};

ErrorStatistics error_statistics(std::vector<double> errors);

}  // namespace penumbra::slam
