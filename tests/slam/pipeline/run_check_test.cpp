#include "slam/pipeline/run_check.h"

#include <gtest/gtest.h>

#include "tests/slam/world/synthetic.h"
#include "tests/support/cv_images.h"

namespace penumbra::slam {
namespace {

class RunCheckTest : public ::testing::Test {
 protected:
  static ByteImage picture(int seed) {
    return test::byte_image(test::textured_image(80, 60, static_cast<std::uint64_t>(seed)));
  }
  static ByteImage grey(int level) { return ByteImage::filled(80, 60, static_cast<std::uint8_t>(level)); }
  // The next frame: where the camera is, metres along z, and what was found.
  void show(RunCheck& check, const ByteImage& left, const ByteImage& right, double z, bool located = true,
            int features = 800, int stereo_features = 500, double depth = 8.0) {
    StereoImages images;
    images.index = frame_;
    images.timestamp = step * frame_++;
    images.left = left;
    images.right = right;
    FrameResult result;
    result.index = images.index;
    result.tracking.state = located ? TrackingState::tracking : TrackingState::lost;
    result.features = features;
    result.stereo_features = stereo_features;
    result.median_depth = stereo_features > 0 ? depth : 0.0;
    result.T_wc.translation.z() = z;
    check.add(images, result);
    for (const std::string& warning : check.take_warnings()) said += warning + "\n";
  }
  void show_good(RunCheck& check, int frames, double metres_a_frame) {
    for (int i = 0; i < frames; ++i) show(check, picture(1), picture(2), metres_a_frame * frame_);
  }
  bool says(const char* text) const { return said.find(text) != std::string::npos; }

  StereoCamera camera = test::test_camera();
  double step = 0.1;  // seconds
  std::string said;

 private:
  int frame_ = 0;
};

TEST_F(RunCheckTest, SaysNothingOfAGoodRun) {
  RunCheck check(camera, Sensor::stereo);
  EXPECT_TRUE(check.take_warnings().empty());
  show_good(check, 40, 1.5);  // 15 m/s
  EXPECT_EQ(said, "");
  EXPECT_EQ(check.why_lost(), "");
  EXPECT_NEAR(check.median_depth(), 8.0, 1e-9);
}

TEST_F(RunCheckTest, SaysThatMillimetresAreNoMetres) {
  camera.baseline = 120.0;
  const std::vector<std::string> warnings = RunCheck(camera, Sensor::stereo).take_warnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("120 m"), std::string::npos);
  EXPECT_NE(warnings[0].find("millimetres"), std::string::npos);
}

TEST_F(RunCheckTest, SaysOnceThatNothingDrivesThatFast) {
  RunCheck check(camera, Sensor::stereo);
  show_good(check, 10, 20.0);  // 200 m/s, nine steps
  EXPECT_EQ(said, "");
  show_good(check, 20, 20.0);
  EXPECT_TRUE(says("200 m/s"));
  EXPECT_EQ(said.find("m/s"), said.rfind("m/s")) << said;
}

TEST_F(RunCheckTest, SaysThatDepthsAreOfNoSensor) {
  for (const double depth : {0.01, 60.0}) {
    said.clear();
    RunCheck check(camera, Sensor::rgbd);
    for (int i = 0; i < 12; ++i) show(check, picture(1), {}, 0.0, true, 800, 500, depth);
    EXPECT_TRUE(says("depth factor")) << depth;
  }
}

TEST_F(RunCheckTest, NamesWhatTheImagesShow) {
  struct Row {
    ByteImage left, right;
    int features, stereo_features;
    const char* says;
  };
  const Row rows[] = {{grey(0), grey(0), 0, 0, "one grey"},
                      {grey(255), picture(2), 0, 0, "one grey"},
                      {picture(1), picture(1), 800, 0, "same image"},
                      {picture(1), picture(2), 12, 9, "hardly any corner"},
                      {picture(1), picture(2), 800, 10, "is found in the right one"}};
  for (const Row& row : rows) {
    said.clear();
    RunCheck check(camera, Sensor::stereo);
    show(check, row.left, row.right, 0.0, false, row.features, row.stereo_features);
    show(check, row.left, row.right, 0.0, false, row.features, row.stereo_features);
    EXPECT_EQ(said, "") << row.says;
    for (int i = 0; i < 8; ++i)
      show(check, row.left, row.right, 0.0, false, row.features, row.stereo_features);
    EXPECT_TRUE(says(row.says)) << said;
    EXPECT_NE(check.why_lost().find(row.says), std::string::npos) << check.why_lost();
    EXPECT_NE(check.why_lost().find("10 of 10 frames"), std::string::npos) << check.why_lost();
    EXPECT_NE(check.why_lost().find("more than half"), std::string::npos) << check.why_lost();
  }
}

TEST_F(RunCheckTest, CountsTheCommonestReason) {
  RunCheck check(camera, Sensor::stereo);
  show_good(check, 5, 0.5);
  check.add_unreadable(5);
  show(check, picture(1), picture(2), 2.5, false);
  show(check, picture(1), picture(2), 2.5, false);
  const std::string why = check.why_lost();
  EXPECT_NE(why.find("3 of 8 frames were not located (frames 5 to 6); 2 of them: too few features agree"),
            std::string::npos)
      << why;
}

}  // namespace
}  // namespace penumbra::slam
