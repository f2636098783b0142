// Disparities of our semi-global matching beside OpenCV's StereoSGBM, in one run, against the truth of a made
// street:
//
//   compare_stereo_depth [SEED]
//
// Five pairs of 1240 x 376, matched at a fourth and at half of that. A row a method: the share of pixels that
// it finds, the median error in pixels of the pair, shares of errors above 1 and 3 of these, and the least
// time on one thread. Not part of the tests: `ninja compare_stereo_depth` builds it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/utility.hpp>
#include <string>
#include <utility>
#include <vector>

#include "nn/base/parallel.h"
#include "nn/base/quantile.h"
#include "nn/base/stage_timer.h"
#include "nn/image/resize.h"
#include "slam/frontend/disparity/dense_disparity.h"
#include "slam/world/street_sequence.h"
#include "tests/support/cv_images.h"

namespace penumbra {
namespace {

constexpr int kDisparities = 128;  // pixels of the pair

struct Row {
  std::vector<double> errors;  // pixels of the pair
  double known = 0.0, seen = 0.0;
  double milliseconds = 1e9;  // of the processor

  // Pixels without truth (the sky) that have a disparity are wrong by 20 pixels.
  void add(const FloatImage& disparity, int shrink, const FloatImage& depth, double fx_b) {
    for (int y = 0; y < disparity.height(); ++y) {
      for (int x = 0; x < disparity.width(); ++x) {
        const float z = depth.at(shrink * x + shrink / 2, shrink * y + shrink / 2);
        const float found = disparity.at(x, y);
        seen += z > 0.0F;
        if (found <= 0.0F) continue;
        known += z > 0.0F;
        errors.push_back(z > 0.0F ? std::min(20.0, std::abs(shrink * found - fx_b / z)) : 20.0);
      }
    }
  }
  double share_above(double pixels) const {
    const auto count = std::count_if(errors.begin(), errors.end(), [&](double e) { return e > pixels; });
    return static_cast<double>(count) / static_cast<double>(errors.size());
  }
  void print(const std::string& name) {
    std::sort(errors.begin(), errors.end());
    fmt::print("{:28} {:6.1f} % {:8.2f} {:6.2f} % {:6.2f} % {:8.1f} ms\n", name, 100.0 * known / seen,
               quantile_of_sorted(errors, 0.5), 100.0 * share_above(1.0), 100.0 * share_above(3.0),
               milliseconds);
  }
};

using Matcher = std::function<FloatImage(const ByteImage& left, const ByteImage& right)>;

Matcher opencv(int shrink, int mode) {
  constexpr int kBlock = 3;  // the best of 3, 5 and 7
  const auto matcher =
      cv::StereoSGBM::create(0, kDisparities / shrink, kBlock, 8 * kBlock * kBlock, 32 * kBlock * kBlock, 1,
                             0, 5, 480 / (shrink * shrink), 1, mode);
  return [matcher](const ByteImage& left, const ByteImage& right) {
    cv::Mat sixteenths;
    matcher->compute(test::to_mat(left), test::to_mat(right), sixteenths);
    FloatImage disparity(left.width(), left.height());
    for (int y = 0; y < disparity.height(); ++y) {
      for (int x = 0; x < disparity.width(); ++x)
        disparity.at(x, y) = std::max(0.0F, static_cast<float>(sixteenths.at<short>(y, x)) / 16.0F);
    }
    return disparity;
  };
}

void compare(std::uint32_t seed) {
  set_thread_count(1);
  cv::setNumThreads(1);
  slam::synthetic::SequenceSettings settings;
  settings.size = {1240, 376};
  settings.seed = seed;
  slam::synthetic::StreetSequence street(settings);
  const double fx_b = street.camera().fx * street.camera().baseline;
  fmt::print("{:28} {:>8} {:>8} {:>8} {:>8} {:>11}\n", "", "found", "median", "> 1 px", "> 3 px", "time");
  for (const int shrink : {4, 2}) {
    slam::DisparitySettings ours;
    ours.disparities = kDisparities / shrink;
    ours.smallest_piece = 480 / (shrink * shrink);
    const auto matcher = std::make_shared<slam::DenseDisparity>(ours);
    const std::vector<std::pair<std::string, Matcher>> methods = {
        {"ours",
         [matcher](const auto& left, const auto& right) { return matcher->find(left, right).clone(); }},
        {"OpenCV, 8 directions", opencv(shrink, cv::StereoSGBM::MODE_HH)},
        {"OpenCV, 5 directions", opencv(shrink, cv::StereoSGBM::MODE_SGBM)},
        {"OpenCV, 3 directions", opencv(shrink, cv::StereoSGBM::MODE_SGBM_3WAY)}};
    std::vector<Row> rows(methods.size());
    slam::synthetic::SequenceFrame frame;
    for (const int i : {0, 12, 24, 36, 48}) {
      street.render(i, frame);
      const Size size{settings.size.width / shrink, settings.size.height / shrink};
      const ByteImage left = resize_area(frame.left_grey, size), right = resize_area(frame.right_grey, size);
      for (std::size_t m = 0; m < methods.size(); ++m) {
        const double begin = thread_processor_ms();
        const FloatImage disparity = methods[m].second(left, right);
        rows[m].milliseconds = std::min(rows[m].milliseconds, thread_processor_ms() - begin);
        rows[m].add(disparity, shrink, frame.left.depth, fx_b);
      }
    }
    for (std::size_t m = 0; m < methods.size(); ++m)
      rows[m].print(fmt::format("1/{}, {}", shrink, methods[m].first));
  }
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  penumbra::compare(argc > 1 ? static_cast<std::uint32_t>(std::atoi(argv[1])) : 900U);
}
