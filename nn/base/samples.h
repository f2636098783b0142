// Numbers of which there is no end, for their quantiles: all of them while they are few, then every second,
// every fourth ... of them, so that a run of any length holds its memory. No random choice: it repeats.
#pragma once

#include <cstddef>
#include <vector>

namespace penumbra {

class Samples {
 public:
  static constexpr std::size_t kMost = 8192;  // are kept; below that, all

  void add(double value) {
    if (count_++ % stride_ != 0) return;
    values_.push_back(value);
    if (values_.size() < kMost) return;
    for (std::size_t i = 0; 2 * i < values_.size(); ++i) values_[i] = values_[2 * i];
    values_.resize(kMost / 2);
    stride_ *= 2;
  }
  // How many there were.
  std::size_t count() const { return count_; }
  // Those that are kept, in their order.
  const std::vector<double>& values() const { return values_; }

 private:
  std::vector<double> values_;
  std::size_t count_ = 0, stride_ = 1;
};

}  // namespace penumbra
