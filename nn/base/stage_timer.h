// Wall-clock time per stage of the pipeline, in milliseconds. Of a stage that runs very often only a sample
// is kept (nn/base/samples.h).
#pragma once

#include <map>
#include <string>

#include "nn/base/samples.h"
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
  void add(const std::string& stage, double milliseconds) { stages_[stage].add(milliseconds); }
  void merge(const StageTimer& other) {
    for (const auto& [stage, times] : other.stages_) {
      Samples& own = stages_[stage];
      for (const double time : times.values()) own.add(time);
    }
  }
  const std::map<std::string, Samples>& stages() const { return stages_; }

 private:
  std::map<std::string, Samples> stages_;
};

}  // namespace penumbra
