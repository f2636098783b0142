// Wall-clock time per stage of the pipeline, in milliseconds.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "nn/base/stopwatch.h"

namespace penumbra {

class StageTimer {
 public:
  // Measures from its construction to its destruction.
  class Scope {
   public:
    Scope(StageTimer& timer, const char* stage) : timer_(timer), stage_(stage) {}
    ~Scope() { timer_.add(stage_, watch_.milliseconds()); }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    StageTimer& timer_;
    const char* stage_;
    const Stopwatch watch_;
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

}  // namespace penumbra
