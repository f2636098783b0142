#include "slam/frontend/features/patch_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "tests/slam/world/synthetic.h"
#include "tests/support/cv_images.h"

namespace penumbra::slam {
namespace {

// The image moved by (dx, dy) and drawn `zoom` times as large about `centre`.
cv::Mat moved(const cv::Mat& image, const Eigen::Vector2d& centre, double zoom, double dx, double dy) {
  const cv::Mat move = (cv::Mat_<double>(2, 3) << zoom, 0, (1 - zoom) * centre.x() + dx, 0, zoom,
                        (1 - zoom) * centre.y() + dy);
  cv::Mat out;
  cv::warpAffine(image, out, move, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  return out;
}

// Blurred as a camera's image is: corners are wider than a pixel.
cv::Mat camera_image(std::uint64_t seed) {
  cv::Mat image = test::textured_image(320, 240, seed);
  cv::GaussianBlur(image, image, cv::Size(5, 5), 1.0);
  return image;
}

Patch patch_at(const cv::Mat& image, float u, float v) {
  ImagePyramid pyramid;
  pyramid.build(test::byte_image(image), {1, 1.2});
  return extract_patch(pyramid, {u, v, 0, 0.0F, 0.0F});
}

// How far the patches of a grid of places are found from where `image` shows them, pixels.
struct Errors {
  int places = 0, found = 0;
  double rms = 0.0;
};

Errors measure(double zoom, double dx, double dy, double gain = 1.0, double noise = 0.0) {
  const cv::Mat from = camera_image(5);
  Errors errors;
  double squares = 0.0;
  for (int v = 40; v < 200; v += 20) {
    for (int u = 40; u < 280; u += 20) {
      cv::Mat to;
      moved(from, {u, v}, zoom, dx, dy).convertTo(to, CV_8U, gain, 10.0);
      if (noise > 0.0) {
        cv::Mat grain(to.size(), CV_16S), sum;
        cv::theRNG().state = static_cast<std::uint64_t>(1000 * v + u);
        cv::randn(grain, 0.0, noise);
        cv::add(to, grain, sum, cv::noArray(), CV_8U);
        to = sum;
      }
      ++errors.places;
      const auto p =
          align_patch(patch_at(from, static_cast<float>(u), static_cast<float>(v)), static_cast<float>(zoom),
                      test::byte_image(to), {static_cast<float>(u), static_cast<float>(v)});
      if (!p) continue;
      ++errors.found;
      squares += (p->cast<double>() - Eigen::Vector2d(u + dx, v + dy)).squaredNorm();
    }
  }
  errors.rms = std::sqrt(squares / std::max(1, errors.found));
  return errors;
}

TEST(PatchAlignment, FindsAShiftToAFractionOfAPixel) {
  for (const auto& [dx, dy] : {std::pair{0.0, 0.0}, {0.5, 0.0}, {-0.3, 0.8}, {1.2, -0.9}}) {
    const Errors errors = measure(1.0, dx, dy);
    EXPECT_GT(errors.found, 0.8 * errors.places) << dx << " " << dy;
    EXPECT_LT(errors.rms, 0.08) << dx << " " << dy;
  }
}

TEST(PatchAlignment, FollowsAChangeOfSize) {
  for (const double zoom : {0.9, 1.1, 1.3}) {
    const Errors errors = measure(zoom, 0.4, -0.3);
    EXPECT_GT(errors.found, 0.8 * errors.places) << zoom;
    EXPECT_LT(errors.rms, 0.08) << zoom;
  }
}

TEST(PatchAlignment, IsBlindToExposure) {
  const Errors errors = measure(1.0, 0.4, 0.6, 0.6);
  EXPECT_GT(errors.found, 0.8 * errors.places);
  EXPECT_LT(errors.rms, 0.08);
}

TEST(PatchAlignment, BearsNoise) {
  const Errors errors = measure(1.0, 0.4, 0.6, 1.0, 5.0);
  EXPECT_GT(errors.found, 0.7 * errors.places);
  EXPECT_LT(errors.rms, 0.25);
}

TEST(PatchAlignment, KeepsThePlaceOfAFeatureBetweenPixels) {
  const cv::Mat image = camera_image(7);
  const Patch patch = patch_at(image, 100.3F, 80.7F);
  EXPECT_NEAR(patch.offset.x(), 0.3, 1e-4);
  EXPECT_NEAR(patch.offset.y(), -0.3, 1e-4);
  const auto p = align_patch(patch, 1.0F, test::byte_image(image), {100.8F, 80.4F});
  ASSERT_TRUE(p);
  EXPECT_NEAR(p->x() + patch.offset.x(), 100.3, 0.02);
  EXPECT_NEAR(p->y() + patch.offset.y(), 80.7, 0.02);
}

TEST(PatchAlignment, RefusesWhatItCannotFind) {
  const cv::Mat image = camera_image(5), other = camera_image(6);
  const Patch patch = patch_at(image, 100.0F, 80.0F);
  ASSERT_FALSE(patch.empty());
  EXPECT_TRUE(align_patch(patch, 1.0F, test::byte_image(image), {100.0F, 80.0F}));
  EXPECT_FALSE(align_patch(patch, 1.0F, test::byte_image(other), {100.0F, 80.0F})) << "another texture";
  EXPECT_FALSE(align_patch(Patch{}, 1.0F, test::byte_image(image), {100.0F, 80.0F})) << "no patch";
  const cv::Mat flat(240, 320, CV_8U, cv::Scalar(90));
  EXPECT_FALSE(align_patch(patch_at(flat, 100.0F, 80.0F), 1.0F, test::byte_image(image), {100.0F, 80.0F}))
      << "no structure";
  EXPECT_FALSE(align_patch(patch, 1.0F, test::byte_image(flat), {100.0F, 80.0F})) << "nothing there";
  cv::Mat edge(240, 320, CV_8U, cv::Scalar(60));
  edge.colRange(100, 320) = 180;
  EXPECT_FALSE(align_patch(patch_at(edge, 100.0F, 80.0F), 1.0F, test::byte_image(edge), {100.0F, 80.0F}))
      << "an edge";
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(),
                  kInf = std::numeric_limits<float>::infinity();
  for (const float bad : {kNaN, kInf, -kInf, -5.0F, 4.9F, 315.0F, 1e9F}) {
    EXPECT_FALSE(align_patch(patch, 1.0F, test::byte_image(image), {bad, 80.0F})) << bad;
    EXPECT_FALSE(
        align_patch(patch, 1.0F, test::byte_image(image), {100.0F, bad < 0 || bad > 200 ? bad : kNaN}))
        << bad;
  }
  for (const float ratio : {kNaN, 0.0F, -1.0F, 0.5F, 2.0F, kInf}) {
    EXPECT_FALSE(align_patch(patch, ratio, test::byte_image(image), {100.0F, 80.0F})) << ratio;
  }
}

TEST(Patch, IsEmptyAtTheBorder) {
  const cv::Mat image = camera_image(5);
  EXPECT_FALSE(patch_at(image, 7.0F, 7.0F).empty());
  EXPECT_TRUE(patch_at(image, 6.0F, 100.0F).empty());
  EXPECT_TRUE(patch_at(image, 100.0F, 233.0F).empty());
  ImagePyramid none;
  EXPECT_TRUE(extract_patch(none, {100.0F, 80.0F, 0, 0.0F, 0.0F}).empty());
}

}  // namespace
}  // namespace penumbra::slam
