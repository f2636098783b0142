// Time per stage of the pipeline, in milliseconds: by the clock on the wall, and of the processor. Of a
// stage that runs very often only a sample of the wall-clock times is kept (nn/base/samples.h).
//
// A timer belongs to one thread at a time. Stages may lie within each other: by the wall each lasts from its
// begin to its end, of the processor each has what is not its inner stages'. The processor's times therefore
// add up, over all stages and threads. Cost: half a microsecond a measurement.
#pragma once

#include <time.h>

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "nn/base/samples.h"
#include "nn/base/stopwatch.h"

namespace penumbra {

// What the calling thread has had of the processor so far, milliseconds.
inline double thread_processor_ms() {
  timespec spent{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &spent);
  return 1e3 * static_cast<double>(spent.tv_sec) + 1e-6 * static_cast<double>(spent.tv_nsec);
}

class StageTimer {
 public:
  // Thread -> stage -> milliseconds of the processor, without those of the stages within it.
  using ProcessorTimes = std::map<std::string, std::map<std::string, double, std::less<>>>;

  // `thread`: what the thread that it measures does.
  explicit StageTimer(const char* thread = "tracking") : thread_(thread) {}

  // Measures from its construction to its destruction.
  class Scope {
   public:
    Scope(StageTimer& timer, const char* stage) : timer_(timer), stage_(stage), outer_(timer.innermost_) {
      timer_.innermost_ = this;
    }
    ~Scope() {
      const double spent = thread_processor_ms() - begin_;
      if (outer_ != nullptr) outer_->inner_ms_ += spent;
      timer_.innermost_ = outer_;
      timer_.add(stage_, watch_.milliseconds());
      timer_.add_processor(stage_, spent - inner_ms_);
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    StageTimer& timer_;
    const char* stage_;
    Scope* const outer_;
    double inner_ms_ = 0.0;  // of the stages within
    const Stopwatch watch_;
    const double begin_ = thread_processor_ms();
  };

  Scope measure(const char* stage) { return Scope(*this, stage); }
  void add(std::string_view stage, double milliseconds) { entry(stages_, stage).add(milliseconds); }
  void merge(const StageTimer& other) {
    for (const auto& [stage, times] : other.stages_) {
      Samples& own = stages_[stage];
      for (const double time : times.values()) own.add(time);
    }
    for (const auto& [thread, stages] : other.processor_) {
      for (const auto& [stage, milliseconds] : stages) processor_[thread][stage] += milliseconds;
    }
  }
  // What was measured so far, which is then forgotten.
  StageTimer take() {
    StageTimer taken;
    taken.stages_.swap(stages_);
    taken.processor_.swap(processor_);
    return taken;
  }
  const std::map<std::string, Samples, std::less<>>& stages() const { return stages_; }
  const ProcessorTimes& processor() const { return processor_; }

 private:
  template <class Value>
  static Value& entry(std::map<std::string, Value, std::less<>>& map, std::string_view key) {
    const auto at = map.find(key);
    return at != map.end() ? at->second : map[std::string(key)];
  }
  void add_processor(std::string_view stage, double milliseconds) {
    entry(processor_[thread_], stage) += milliseconds;
  }

  std::string thread_;
  std::map<std::string, Samples, std::less<>> stages_;
  ProcessorTimes processor_;
  Scope* innermost_ = nullptr;  // that is being measured
};

}  // namespace penumbra
