#include "slam/geometry/time_unit.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "tests/support/expect_error.h"

namespace penumbra::slam {
namespace {

constexpr TimeRule kNames{400.0, std::nullopt};

std::vector<FileTime> times(double start, double step, int count = 5) {
  std::vector<FileTime> list;
  for (int i = 0; i < count; ++i) list.push_back(to_file_time(start + step * i));
  return list;
}

TEST(TimeUnit, AbsoluteClocksAreKnownByTheirDigits) {
  const TimeRule rules[] = {kCameraSeconds, kCameraNanoseconds, kPoseSeconds, kPoseNanoseconds, kNames};
  for (const TimeRule& rule : rules) {
    EXPECT_EQ(find_time_unit(times(1.403636579e9, 0.05), rule, "f"), TimeUnit::seconds);
    EXPECT_EQ(find_time_unit(times(1.403636579e9, 1), rule, "f"), TimeUnit::seconds);
    EXPECT_EQ(find_time_unit(times(1.403636579763e12, 50), rule, "f"), TimeUnit::milliseconds);
    EXPECT_EQ(find_time_unit(times(1.403636579763e12, 5), rule, "f"), TimeUnit::milliseconds);
    EXPECT_EQ(find_time_unit(times(1.403636579763e15, 62500), rule, "f"), TimeUnit::microseconds);
    EXPECT_EQ(find_time_unit(times(1.403636579763e18, 5e7), rule, "f"), TimeUnit::nanoseconds);
    EXPECT_EQ(find_time_unit(times(1.403636579763e18, 1.5e9), rule, "f"), TimeUnit::nanoseconds);
    EXPECT_EQ(find_time_unit(times(1.6e18, 0, 1), rule, "f"), TimeUnit::nanoseconds);
  }
}

TEST(TimeUnit, ClocksThatBeginAnywhereAreKnownByTheirStep) {
  for (const double start : {0.0, 1e4}) {
    for (const TimeRule& rule : {kCameraSeconds, kPoseSeconds}) {
      EXPECT_EQ(find_time_unit(times(start, 0.1), rule, "f"), TimeUnit::seconds);
      EXPECT_EQ(find_time_unit(times(start, 1), rule, "f"), TimeUnit::seconds);  // or frame numbers
      EXPECT_EQ(find_time_unit(times(start, 2), rule, "f"), TimeUnit::seconds);
      EXPECT_EQ(find_time_unit(times(start, 33), rule, "f"), TimeUnit::milliseconds);
      EXPECT_EQ(find_time_unit(times(start, 100), rule, "f"), TimeUnit::milliseconds);
      EXPECT_EQ(find_time_unit(times(start, 33333), rule, "f"), TimeUnit::microseconds);
      EXPECT_EQ(find_time_unit(times(start, 33333333), rule, "f"), TimeUnit::nanoseconds);
    }
  }
  // Switched on 16 days ago: as many digits as microseconds since 1970.
  EXPECT_EQ(find_time_unit(times(1.4e15, 5e7), kCameraNanoseconds, "f"), TimeUnit::nanoseconds);
  EXPECT_EQ(find_time_unit(times(1.4e15, 5e7), kNames, "f"), TimeUnit::nanoseconds);
  EXPECT_EQ(find_time_unit(times(0.0, 1e6), kPoseNanoseconds, "f"), TimeUnit::nanoseconds);  // 1000 Hz
  EXPECT_EQ(find_time_unit(times(0.0, 33.3), kCameraSeconds, "f"), TimeUnit::milliseconds);
  EXPECT_EQ(find_time_unit(times(0.0, 10.5), kCameraSeconds, "f"), TimeUnit::seconds);
}

TEST(TimeUnit, WhatFitsNoneIsRefused) {
  test::expect_error<InputError>([] { find_time_unit(times(0.0, 1e13), kCameraSeconds, "times.txt"); },
                                 {"times.txt", "nanoseconds", "a usual step of 1e+13"});
  test::expect_error<InputError>([] { find_time_unit(times(0.0, 1e-7), kPoseSeconds, "t"); }, {"1e-07"});
}

TEST(TimeUnit, WholeNumbersKeepTheirDigits) {
  const FileTime a = parse_file_time("1403636579763555584", "f"),
                 b = parse_file_time("1403636579763655584", "f");
  EXPECT_NEAR(to_seconds(b, TimeUnit::nanoseconds) - to_seconds(a, TimeUnit::nanoseconds), 1e-4, 3e-7);
  EXPECT_EQ(to_seconds(parse_file_time("-1500", "f"), TimeUnit::milliseconds), -1.5);
  EXPECT_EQ(to_seconds(parse_file_time("12.25", "f"), TimeUnit::seconds), 12.25);
  EXPECT_EQ(parse_file_time("1.403636579763555584e+18", "f").whole.value() / 1000, 1403636579763555);
  test::expect_error<InputError>([] { parse_file_time("x", "f:3"); }, {"f:3", "'x'"});
  test::expect_error<InputError>([] { parse_file_time("", "f:3"); }, {"f:3", "nothing"});
}

TEST(TimeUnit, ItIsSaidWhichUnitWasTaken) {
  std::vector<std::string> notes;
  EXPECT_EQ(to_seconds(times(0.0, 0.1), kCameraSeconds, "f", notes).size(), 5U);
  EXPECT_TRUE(notes.empty());
  to_seconds(times(1.4e15, 62500), kCameraSeconds, "times.txt", notes);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes.front(),
            "times.txt: the times are taken as microseconds (not seconds): the usual step is then 0.0625 s");
}

}  // namespace
}  // namespace penumbra::slam
