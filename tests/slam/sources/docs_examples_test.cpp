// The calibrations that docs/datasets.md shows are read as they stand there.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "nn/base/file.h"
#include "slam/sources/calibration/calibration.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

// The indented blocks of a page that hold `mark`, without their indent.
std::vector<std::string> blocks(const std::string& page, const std::string& mark) {
  std::vector<std::string> found;
  std::string block;
  for (std::size_t start = 0; start < page.size();) {
    const std::size_t end = std::min(page.find('\n', start), page.size());
    const std::string line = page.substr(start, end - start);
    start = end + 1;
    if (line.starts_with("    ")) {
      block += line.substr(4) + "\n";
    } else if (!block.empty()) {
      if (block.find(mark) != std::string::npos) found.push_back(block);
      block.clear();
    }
  }
  return found;
}

class DocsExamples : public testing::Test {
 protected:
  CameraFile read(const std::string& text) const {
    nn::write_file(folder_ / "calibration.yaml", text);
    return read_camera_file(folder_ / "calibration.yaml");
  }
  const std::vector<std::string> examples_ =
      blocks(nn::read_file(test::source_path("docs/datasets.md"), "the page"), "fx:");
  test::TemporaryDirectory folder_;
};

TEST_F(DocsExamples, AreReadAndMakeCameras) {
  ASSERT_EQ(examples_.size(), 3U);
  for (const std::string& example : examples_) {
    const StereoCamera camera = make_camera(read(example)).camera;
    EXPECT_GT(camera.fx, 100.0) << example;
    EXPECT_GT(camera.baseline, 0.05) << example;
  }
}

TEST_F(DocsExamples, RawPairIsTurnedAsEurocSays) {
  // T_BS of the two cameras, from the sensor.yaml of EuRoC's V1_01_easy.
  const SE3 T_B_left{(Eigen::Matrix3d() << 0.0148655429818, -0.999880929698, 0.00414029679422, 0.999557249008,
                      0.0149672133247, 0.025715529948, -0.0257744366974, 0.00375618835797, 0.999660727178)
                         .finished(),
                     {-0.0216401454975, -0.064676986768, 0.00981073058949}};
  const SE3 T_B_right{(Eigen::Matrix3d() << 0.0125552670891, -0.999755099723, 0.0182237714554, 0.999598781151,
                       0.0130119051815, 0.0251588363115, -0.0253898008918, 0.0179005838253, 0.999517347078)
                          .finished(),
                      {-0.0198435579556, 0.0453689425024, 0.00786212447038}};
  const SE3 expected = T_B_right.inverse() * T_B_left;
  const SE3 shown = read(examples_.at(1)).T_right_left;
  EXPECT_LT((shown.rotation - expected.rotation).norm(), 1e-6);
  EXPECT_LT((shown.translation - expected.translation).norm(), 1e-6);
}

}  // namespace
}  // namespace penumbra::slam
