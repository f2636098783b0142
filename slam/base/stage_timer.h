// Wall-clock time per stage of the pipeline, in milliseconds.
#pragma once

#include <algorithm>
#include <chrono>
#include <map>
#include <string>
#include <vector>

namespace penumbra::slam {

// The value below which a share `q` (0..1) of `values` lies; 0 for no values.
inline double quantile_of(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

class StageTimer {
 public:
  // Measures from its construction to its destruction.
  class Scope {
   public:
    Scope(StageTimer& timer, const char* stage)
        : timer_(timer), stage_(stage), start_(std::chrono::steady_clock::now()) {}
    ~Scope() {
      timer_.add(
          stage_,
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count());
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    StageTimer& timer_;
    const char* stage_;
    std::chrono::steady_clock::time_point start_;
  };

  Scope measure(const char* stage) { return Scope(*this, stage); }
  void add(const std::string& stage, double milliseconds) { stages_[stage].push_back(milliseconds); }
  void merge(const StageTimer& other) {
    for (const auto& [stage, times] : other.stages_) {
      std::vector<double>& own = stages_[stage];
      own.insert(own.end(), times.begin(), times.end());
    }
  }
  // Stage -> one entry per time it ran.
  const std::map<std::string, std::vector<double>>& stages() const { return stages_; }

 private:
  std::map<std::string, std::vector<double>> stages_;
};

}  // namespace penumbra::slam
