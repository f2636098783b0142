#include "apps/network/recording_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/common/log.h"
#include "nn/base/counted.h"
#include "nn/base/text.h"
#include "slam/sources/bag_recording.h"

namespace penumbra::apps {

namespace {

double seconds(std::int64_t nanoseconds) { return static_cast<double>(nanoseconds) * 1e-9; }

// Messages a second by the times of recording; 0 where they do not tell.
double rate_of(const slam::Topic& topic) {
  const double span = seconds(topic.last) - seconds(topic.first);
  return topic.messages < 2 || !(span > 0.0) ? 0.0 : static_cast<double>(topic.messages - 1) / span;
}

struct Span {
  std::uint64_t messages = 0;
  std::int64_t first = 0, last = 0;
};

Span span_of(const slam::BagSummary& summary) {
  Span span;
  for (const slam::Topic& topic : summary.topics) {
    if (topic.messages == 0) continue;
    span.first = span.messages == 0 ? topic.first : std::min(span.first, topic.first);
    span.last = span.messages == 0 ? topic.last : std::max(span.last, topic.last);
    span.messages += topic.messages;
  }
  return span;
}

void print_json(const std::string& file, const slam::BagSummary& summary) {
  nlohmann::ordered_json topics = nlohmann::ordered_json::array();
  for (const slam::Topic& topic : summary.topics) {
    topics.push_back({{"topic", printable(topic.name)},
                      {"type", printable(topic.type)},
                      {"encoding", printable(topic.encoding)},
                      {"messages", topic.messages},
                      {"rate_hz", rate_of(topic)},
                      {"first_s", seconds(topic.first)},
                      {"last_s", seconds(topic.last)}});
  }
  std::vector<std::string> frames;
  for (const std::string& frame : summary.frames) frames.push_back(printable(frame));
  const Span span = span_of(summary);
  const nlohmann::ordered_json info = {{"file", file},
                                       {"format", summary.kind},
                                       {"messages", span.messages},
                                       {"seconds", seconds(span.last) - seconds(span.first)},
                                       {"topics", topics},
                                       {"taken", summary.taken},
                                       {"not_taken", summary.reason},
                                       {"frames", frames},
                                       {"notes", summary.notes}};
  fmt::print("{}\n", info.dump(2));
}

void print_table(const std::string& file, const slam::BagSummary& summary) {
  std::size_t name_width = 5, type_width = 4;
  for (const slam::Topic& topic : summary.topics) {
    name_width = std::max(name_width, printable(topic.name).size());
    type_width = std::max(type_width, printable(topic.type).size());
  }
  fmt::print("{:<{}}  {:<{}}  {:<8}  {:>8}  {:>8}  {:>10}\n", "topic", name_width, "type", type_width,
             "encoding", "messages", "Hz", "seconds");
  for (const slam::Topic& topic : summary.topics) {
    fmt::print("{:<{}}  {:<{}}  {:<8}  {:>8}  {:>8.2f}  {:>10.3f}\n", printable(topic.name), name_width,
               printable(topic.type), type_width, printable(topic.encoding, 20), topic.messages,
               rate_of(topic), seconds(topic.last) - seconds(topic.first));
  }
  const Span span = span_of(summary);
  fmt::print("{}: {}, {}, {}, recorded from {:.3f} to {:.3f} s\n", file, summary.kind,
             counted(summary.topics.size(), "topic"), counted(span.messages, "message"), seconds(span.first),
             seconds(span.last));
  if (!summary.taken.empty()) {
    fmt::print("penumbra slam takes: {}\n", summary.taken);
    if (!summary.frames.empty()) {
      std::string frames;
      for (const std::string& frame : summary.frames)
        frames += (frames.empty() ? "" : ", ") + printable(frame, 60);
      fmt::print("frames in which the left camera stands still (--body): {}\n", frames);
    }
  } else {
    fmt::print("penumbra slam finds no two topics that belong together{}\n",
               summary.reason.empty() ? "" : ": " + summary.reason);
  }
}

}  // namespace

void show_recording(const std::filesystem::path& path, bool json) {
  const slam::BagSummary summary = slam::summarise_bag(path);
  const std::string file = printable(path.string(), 400);
  for (const std::string& note : summary.notes) log_warning("{}", note);
  if (json) {
    print_json(file, summary);
  } else {
    print_table(file, summary);
  }
}

}  // namespace penumbra::apps
