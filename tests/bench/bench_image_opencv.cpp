// Our image operations beside OpenCV's, on the same image in one run, one thread each:
//
//   bench_image_opencv [IMAGE [REPEATS]]
//
// A row an operation: the medians, and ours as a share of OpenCV's. Both take turns. Not part of the tests:
// `ninja bench_image_opencv` builds it.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "apps/bench/image_operations.h"
#include "nn/image/colour.h"
#include "nn/simd/isa.h"
#include "tests/support/cv_images.h"

namespace penumbra {
namespace {

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Under the names of apps::image_operations.
std::vector<apps::ImageOperation> opencv_operations(const ByteImage& image) {
  struct State {
    cv::Mat grey, colour, out, colour_out, depth, depth_out, gx, gy, linear, weights, nearest, unused;
    std::vector<cv::KeyPoint> corners;
    cv::Mat next;
    std::vector<cv::Mat> from, to;
    std::vector<cv::Point2f> points, moved;
    std::vector<unsigned char> status;
  };
  const auto s = std::make_shared<State>();
  s->grey = test::to_mat(image);
  s->colour = test::to_mat(grey_to_bgr(image.view()));
  s->depth = cv::Mat(s->grey.size(), CV_16U, cv::Scalar(5000));
  const apps::BenchmarkMap map = apps::benchmark_map(image.size());
  cv::convertMaps(test::to_mat(map.x), test::to_mat(map.y), s->linear, s->weights, CV_16SC2, false);
  cv::convertMaps(test::to_mat(map.x), test::to_mat(map.y), s->nearest, s->unused, CV_16SC2, true);
  const Size level = apps::next_level(image.size());
  const cv::Size smaller(level.width, level.height);
  const auto move = [s](const cv::Mat& from, cv::Mat& to) {
    cv::remap(from, to, s->linear, s->weights, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  };
  const cv::Size window(21, 21);
  move(s->grey, s->next);
  cv::buildOpticalFlowPyramid(s->grey, s->from, window, apps::kFlowLevels - 1);
  for (const FlowPoint& p : apps::benchmark_points(image)) s->points.emplace_back(p.x, p.y);
  return {
      {"corners, threshold 20", [s] { cv::FAST(s->grey, s->corners, 20, true); }},
      {"corners, threshold 7", [s] { cv::FAST(s->grey, s->corners, 7, true); }},
      {"blur",
       [s] {
         cv::GaussianBlur(s->grey, s->out, {7, 7}, 2.0, 2.0, cv::BORDER_REFLECT_101);
       }},
      {"resize, grey", [s, smaller] { cv::resize(s->grey, s->out, smaller, 0, 0, cv::INTER_LINEAR); }},
      {"resize, colour",
       [s, smaller] { cv::resize(s->colour, s->colour_out, smaller, 0, 0, cv::INTER_LINEAR); }},
      {"resize by area, colour",
       [s, smaller] { cv::resize(s->colour, s->colour_out, smaller, 0, 0, cv::INTER_AREA); }},
      {"remap, grey", [s, move] { move(s->grey, s->out); }},
      {"remap, colour", [s, move] { move(s->colour, s->colour_out); }},
      {"remap, nearest",
       [s] {
         cv::remap(s->depth, s->depth_out, s->nearest, cv::Mat(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
       }},
      {"colour to grey", [s] { cv::cvtColor(s->colour, s->out, cv::COLOR_BGR2GRAY); }},
      {"point flow, 500 points",
       [s, window] {
         cv::buildOpticalFlowPyramid(s->next, s->to, window, apps::kFlowLevels - 1);
         if (!s->points.empty())
           cv::calcOpticalFlowPyrLK(s->from, s->to, s->points, s->moved, s->status, cv::noArray());
       }},
      {"slopes",
       [s] {
         cv::Sobel(s->grey, s->gx, CV_32F, 1, 0, 3, 1.0 / 8.0);
         cv::Sobel(s->grey, s->gy, CV_32F, 0, 1, 3, 1.0 / 8.0);
       }},
  };
}

void compare(const ByteImage& image, int repeats) {
  cv::setNumThreads(1);
  fmt::print("{} x {} pixels, one thread; ours on {}, OpenCV {} as it chooses\n", image.width(),
             image.height(), to_string(nn::current_isa()), CV_VERSION);
  fmt::print("{:<24} {:>9} {:>10} {:>6}\n", "operation", "ours ms", "OpenCV ms", "ratio");
  const auto ours = apps::image_operations(image), theirs = opencv_operations(image);
  for (std::size_t i = 0; i < ours.size(); ++i) {
    std::vector<double> a, b;
    for (int run = -2; run < repeats; ++run) {  // the first two to warm up
      const double mine = seconds_of(ours[i].run), other = seconds_of(theirs[i].run);
      if (run < 0) continue;
      a.push_back(mine);
      b.push_back(other);
    }
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    const double mine = a[a.size() / 2], other = b[b.size() / 2];
    fmt::print("{:<24} {:>9.3f} {:>10.3f} {:>6.2f}\n", ours[i].name, mine * 1e3, other * 1e3, mine / other);
  }
}

}  // namespace
}  // namespace penumbra

int main(int argc, char** argv) {
  using namespace penumbra;
  const ByteImage image =
      argc > 1 ? nn::read_image(argv[1], nn::ImageColour::grey) : apps::benchmark_image(1241, 376);
  compare(image, argc > 2 ? std::max(1, std::atoi(argv[2])) : 101);
}
