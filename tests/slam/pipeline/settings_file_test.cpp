#include "slam/pipeline/settings_file.h"

#include <gtest/gtest.h>

#include <set>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/pipeline/setting_fields.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

class SettingsFile : public testing::Test {
 protected:
  SlamSettings read(const std::string& text) {
    nn::write_file(file_, text);
    SlamSettings settings;
    read_settings(file_, settings);
    return settings;
  }
  void expect_refused(const std::string& text, std::initializer_list<std::string> parts) {
    test::expect_error<InputError>([&] { read(text); }, parts);
  }

  test::TemporaryDirectory folder_;
  std::filesystem::path file_ = folder_ / "mine.json";
};

TEST_F(SettingsFile, WhatIsPrintedIsReadBack) {
  SlamSettings settings;
  settings.tracker.search_radius = 12.25F;
  settings.tracker.mismatch_filter.mode = MismatchFilterMode::compensated;
  settings.semantics.mode = SegmentationMode::interval;
  settings.loops.enabled = false;
  settings.loops.correction.pose_graph.initial_lambda = 1e-9;
  settings.mapper.bundle.window = 7;
  const std::string text = settings_text(settings);
  EXPECT_EQ(settings_text(read(text)), text);
  EXPECT_NE(text, settings_text(SlamSettings()));
}

TEST_F(SettingsFile, FieldsHaveNamesOfTheirOwnAndDefaultsWithinTheirBounds) {
  SlamSettings settings;
  std::set<std::string> names;
  for (const SettingField& field : setting_fields(settings)) {
    EXPECT_TRUE(names.insert(field.name).second) << field.name;
  }
  EXPECT_GT(names.size(), 150U);
  EXPECT_NO_THROW(check_settings(settings, "defaults"));
}

TEST_F(SettingsFile, WhatIsNotNamedStays) {
  const SlamSettings settings = read(R"(// a comment
    {"tracker": {"local_keyframes": 30, "recognition": {"last": {"fewest_inliers": 25}}}})");
  EXPECT_EQ(settings.tracker.local_keyframes, 30);
  EXPECT_EQ(settings.tracker.recognition.last.fewest_inliers, 25);
  EXPECT_EQ(settings.tracker.recognition.anywhere.fewest_inliers, 40);
  EXPECT_EQ(settings.threads, SlamSettings().threads);
}

TEST_F(SettingsFile, SlipsAreNamed) {
  expect_refused(R"({"tracker": {"search_radios": 12}})",
                 {"mine.json, tracker", "search_radios", "tracker.search_radius"});
  expect_refused(R"({"tracker": {"search_radius": -1}})", {"tracker.search_radius", "0 to 10000", "-1"});
  expect_refused(R"({"dense": {"voxel": 1e-9}})", {"dense.voxel", "0.001 to 10 metres; 0: by the sensor"});
  expect_refused(R"({"dense": {"depth_noise": 1e-9}})", {"dense.depth_noise", "1e-06 to 1"});
  expect_refused(R"({"dense": {"plan": {"cell": 1e-9}}})", {"dense.plan.cell", "0.001 to 100"});
  expect_refused(R"({"dense": {"plan": {"lowest": -0.5}}})", {"dense.plan.lowest", "0.001 to 100"});
  EXPECT_NO_THROW(read(R"({"dense": {"voxel": 0, "farthest": 0, "plan": {"cell": 0.001}}})"));
  expect_refused(R"({"tracker": {"search_radius": "10"}})",
                 {"tracker.search_radius", "a number, pixels", "10"});
  expect_refused(R"({"tracker": {"local_keyframes": 2.5}})", {"a whole number, keyframes", "2.5"});
  expect_refused(R"({"tracker": 3})", {"mine.json, tracker", "an object of settings", "3"});
  expect_refused(R"({"loops": {"enabled": 1}})", {"loops.enabled", "true or false", "1"});
  expect_refused(R"({"semantics": {"mode": "sometimes"}})", {"keyframes, interval, all", "sometimes"});
  expect_refused(R"({"threads": 2, "threads": 3})", {"every setting once", "threads"});
  expect_refused("{\n\"threads\": 2,\n", {"mine.json:3", "JSON"});
  expect_refused(R"({"orb.features": 3})", {"orb.features"});
  expect_refused(R"({"orb": {"scale_factor": 1e400}})", {"mine.json", "1e400"});
  expect_refused("", {"mine.json"});
  expect_refused("[]", {"an object of settings"});
}

}  // namespace
}  // namespace penumbra::slam
