#include "slam/brain/motion/odometry_file.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "tests/support/test_data.h"

namespace penumbra::slam::brain {
namespace {

class OdometryFile : public ::testing::Test {
 protected:
  std::vector<OdometrySample> read(const std::string& text) {
    nn::write_file(folder_.path() / "odometry.txt", text);
    return read_odometry(folder_.path() / "odometry.txt");
  }
  std::string error_of(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  test::TemporaryDirectory folder_;
};

TEST_F(OdometryFile, TakesSpacesCommasCommentsAndNanoseconds) {
  const std::vector<OdometrySample> a = read("# time v omega\n0.0 1.0 0.1\n0.5,2.0,-0.1\n");
  ASSERT_EQ(a.size(), 2U);
  EXPECT_EQ(a[1].speed, 2.0);
  EXPECT_EQ(a[1].turn_rate, -0.1);
  const std::vector<OdometrySample> b = read("#t,v,w\n1403636579763555584,1,0\n1403636579863555584,1,0\n");
  EXPECT_NEAR(b[1].time - b[0].time, 0.1, 1e-6);
}

TEST_F(OdometryFile, NamesTheLineOfWhatIsWrong) {
  EXPECT_NE(error_of("0 1 0\n1 1\n").find("odometry.txt:2"), std::string::npos);
  EXPECT_NE(error_of("0 1 0\n1 nan 0\n").find("odometry.txt:2"), std::string::npos);
  EXPECT_NE(error_of("0 1 0\n2 1 0\n1 1 0\n").find("odometry.txt:3"), std::string::npos);
  EXPECT_NE(error_of("0 1 0\n0 1 0\n").find("a time after"), std::string::npos);
  EXPECT_NE(error_of("# nothing\n").find("at least two"), std::string::npos);
}

double way_of(const std::vector<SelfMotion>& motions) {
  double way = 0.0;
  for (const SelfMotion& motion : motions) way += motion.speed * motion.seconds;
  return way;
}

double seconds_of(const std::vector<SelfMotion>& motions) {
  double seconds = 0.0;
  for (const SelfMotion& motion : motions) seconds += motion.seconds;
  return seconds;
}

TEST(OdometryOfFrames, CutsSamplesAtTheFrames) {
  // 10 m/s from 0 s on, 20 m/s from 0.25 s on.
  const OdometryOfFrames of = odometry_of_frames({{0.0, 10.0, 0.0}, {0.25, 20.0, 0.0}, {0.5, 0.0, 0.0}},
                                                 {0.1, 0.2, 0.3, 0.4}, "odometry.txt");
  ASSERT_EQ(of.motions.size(), 4U);
  EXPECT_TRUE(of.motions[0].empty());
  EXPECT_NEAR(way_of(of.motions[1]), 1.0, 1e-12);
  EXPECT_NEAR(way_of(of.motions[2]), 0.5 + 1.0, 1e-12);
  EXPECT_NEAR(way_of(of.motions[3]), 2.0, 1e-12);
  EXPECT_TRUE(of.notes.empty());
}

TEST(OdometryOfFrames, StandsStillInGapsAndSaysSo) {
  const OdometryOfFrames of =
      odometry_of_frames({{0.0, 10.0, 0.0}, {5.0, 10.0, 0.0}}, {0.0, 3.0, 6.0}, "odometry.txt");
  EXPECT_NEAR(way_of(of.motions[1]), 10.0 * kLongestGap, 1e-12);
  EXPECT_NEAR(way_of(of.motions[2]), 10.0, 1e-12);
  EXPECT_NEAR(seconds_of(of.motions[1]), 3.0, 1e-12);
  EXPECT_NEAR(seconds_of(of.motions[2]), 3.0, 1e-12);
  ASSERT_FALSE(of.notes.empty());
  EXPECT_NE(of.notes[0].find("gap"), std::string::npos);
}

TEST(OdometryOfFrames, SaysWhichFramesItMisses) {
  const OdometryOfFrames of = odometry_of_frames({{2.0, 10.0, 0.0}, {2.1, 10.0, 0.0}},
                                                 {0.0, 0.5, 1.0, 1.5, 2.0, 2.1, 2.2, 2.3}, "odometry.txt");
  EXPECT_NEAR(way_of(of.motions[1]), 0.0, 1e-12) << "more than a second before the first sample";
  EXPECT_NEAR(way_of(of.motions[3]), 5.0, 1e-12);
  ASSERT_EQ(of.notes.size(), 1U);
  EXPECT_NE(of.notes[0].find("before its first or after its last sample: "), std::string::npos);
}

TEST(OdometryOfFrames, RefusesAnotherClock) {
  EXPECT_THROW(odometry_of_frames({{0.0, 1.0, 0.0}, {1.0, 1.0, 0.0}}, {100.0, 101.0}, "o"), InputError);
  EXPECT_THROW(odometry_of_frames({{0.0, 1.0, 0.0}, {1.0, 1.0, 0.0}}, {}, "o"), InputError);
}

TEST(OdometryOfFrames, AsksWhetherTurnsAreDegrees) {
  const OdometryOfFrames of = odometry_of_frames({{0.0, 1.0, 0.0}, {1.0, 1.0, 45.0}}, {0.0, 1.0}, "o");
  ASSERT_EQ(of.notes.size(), 1U);
  EXPECT_NE(of.notes[0].find("degrees"), std::string::npos);
}

}  // namespace
}  // namespace penumbra::slam::brain
