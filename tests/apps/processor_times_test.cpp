#include "apps/view/processor_times.h"

#include <gtest/gtest.h>

#include <cmath>

namespace penumbra::apps {
namespace {

// Keeps the processor busy for so many milliseconds of its time.
void work(double milliseconds) {
  const double begin = thread_processor_ms();
  volatile double x = 1.0;
  while (thread_processor_ms() - begin < milliseconds) x = std::sqrt(x + 1.0);
}

TEST(ProcessorTimes, OfAStageAreWithoutThoseOfTheStagesInIt) {
  StageTimer timer("mapping"), other("images");
  {
    const auto outer = timer.measure("outer");
    work(2.0);
    const auto inner = timer.measure("inner");
    work(6.0);
  }
  {
    const auto scope = other.measure("decoding");
    work(1.0);
  }
  const double outer = timer.processor().at("mapping").at("outer"),
               inner = timer.processor().at("mapping").at("inner");
  EXPECT_GE(outer, 2.0);
  EXPECT_GE(inner, 6.0);
  EXPECT_LT(outer, inner);
  EXPECT_EQ(timer.stages().at("outer").count(), 1U);
  StageTimer all = timer.take();
  EXPECT_TRUE(timer.stages().empty());
  EXPECT_TRUE(timer.processor().empty());
  all.merge(other);
  EXPECT_EQ(all.processor().size(), 2U);
  EXPECT_EQ(all.processor().at("mapping").at("outer"), outer);
}

TEST(ProcessorTimes, AddUpToThoseOfTheProcess) {
  const StageTimer::ProcessorTimes times = {{"tracking", {{"orb", 40.0}, {"pose", 10.0}}},
                                            {"images", {{"decoding", 20.0}}}};
  const nlohmann::json report = processor_report(times, 0.1, 10);
  EXPECT_DOUBLE_EQ(report["tracking"]["orb"].get<double>(), 4.0);
  EXPECT_DOUBLE_EQ(report["tracking"]["pose"].get<double>(), 1.0);
  EXPECT_DOUBLE_EQ(report["images"]["decoding"].get<double>(), 2.0);
  EXPECT_DOUBLE_EQ(report["other"].get<double>(), 3.0);
  EXPECT_EQ(processor_report({}, 0.0, 0)["other"], 0.0);
}

TEST(ProcessorTimes, TheTableHasTheDearestFirst) {
  const std::string table = processor_table(processor_report(
      {{"tracking", {{"orb", 40.0}, {"pose", 10.0}}}, {"images", {{"decoding", 70.0}}}}, 0.15, 10));
  const auto at = [&](const char* word) { return table.find(word); };
  EXPECT_LT(at("images"), at("decoding"));
  EXPECT_LT(at("decoding"), at("tracking"));
  EXPECT_LT(at("tracking"), at("orb"));
  EXPECT_LT(at("orb"), at("pose"));
  EXPECT_LT(at("pose"), at("other"));
  EXPECT_LT(at("other"), at("all threads"));
  EXPECT_NE(table.find("15.00"), std::string::npos) << table;
  EXPECT_NE(table.find("46.7 %"), std::string::npos) << table;
}

}  // namespace
}  // namespace penumbra::apps
