#include "apps/view/processor_times.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "apps/common/rounded.h"

namespace penumbra::apps {

namespace {

constexpr const char* kNotTimed = "other";

using Row = std::pair<double, std::string>;  // milliseconds, text

double total(const nlohmann::json& stages) {
  if (stages.is_number()) return stages.get<double>();
  double sum = 0.0;
  for (const nlohmann::json& ms : stages) sum += ms.get<double>();
  return sum;
}

std::string row_text(const std::string& name, double ms, double all) {
  return fmt::format("{:<26}{:>9.2f}{:>7.1f} %\n", name, ms, all > 0.0 ? 100.0 * ms / all : 0.0);
}

// The dearest first.
std::string joined(std::vector<Row> rows) {
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.first > b.first; });
  std::string text;
  for (const Row& row : rows) text += row.second;
  return text;
}

}  // namespace

nlohmann::json processor_report(const StageTimer::ProcessorTimes& times, double cpu_seconds,
                                std::size_t frames) {
  const double count = static_cast<double>(std::max<std::size_t>(frames, 1));
  nlohmann::json json = nlohmann::json::object();
  double not_timed = 1000.0 * cpu_seconds / count;
  for (const auto& [thread, stages] : times) {
    for (const auto& [stage, ms] : stages) {
      json[thread][stage] = to_a_thousandth(ms / count);
      not_timed -= ms / count;
    }
  }
  json[kNotTimed] = to_a_thousandth(std::max(0.0, not_timed));
  return json;
}

std::string processor_table(const nlohmann::json& report) {
  double all = 0.0;
  for (const nlohmann::json& thread : report) all += total(thread);
  std::vector<Row> threads;
  for (const auto& [thread, stages] : report.items()) {
    const double sum = total(stages);
    std::vector<Row> rows;
    if (stages.is_object()) {
      for (const auto& [stage, ms] : stages.items())
        rows.emplace_back(ms.get<double>(), row_text(fmt::format("  {}", stage), ms.get<double>(), all));
    }
    threads.emplace_back(sum, row_text(thread, sum, all) + joined(std::move(rows)));
  }
  return fmt::format("{:<26}{:>9}{:>9}\n", "processor time", "ms/frame", "share") +
         joined(std::move(threads)) + row_text("all threads", all, all);
}

}  // namespace penumbra::apps
