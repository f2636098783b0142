#include "apps/network/overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace penumbra::apps {

namespace {

constexpr int kSmallestWidth = 640;  // pixels
constexpr double kMaskOpacity = 0.45;

// A colour of its own for every instance: hues a golden angle apart stay far from each other.
cv::Scalar instance_colour(std::size_t i) {
  const double hue = std::fmod(0.09 + 0.61803398875 * static_cast<double>(i), 1.0);
  cv::Mat3b pixel(1, 1, cv::Vec3b(static_cast<std::uint8_t>(hue * 180.0), 200, 255));
  cv::cvtColor(pixel, pixel, cv::COLOR_HSV2BGR);
  return {static_cast<double>(pixel(0)[0]), static_cast<double>(pixel(0)[1]),
          static_cast<double>(pixel(0)[2])};
}

// The mask as an image of `size` pixels, 0 or 255.
cv::Mat1b full_mask(const nn::Mask& mask, const cv::Size& image, const cv::Size& size) {
  cv::Mat1b full(image, std::uint8_t{0});
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      if (mask.contains(mask.x + x, mask.y + y)) full(mask.y + y, mask.x + x) = 255;
    }
  }
  if (size != image) cv::resize(full, full, size, 0, 0, cv::INTER_NEAREST);
  return full;
}

void blend(cv::Mat& picture, const cv::Mat1b& mask, const cv::Scalar& colour) {
  for (int y = 0; y < picture.rows; ++y) {
    auto* row = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < picture.cols; ++x) {
      if (mask(y, x) == 0) continue;
      for (int c = 0; c < 3; ++c) {
        row[x][c] =
            cv::saturate_cast<std::uint8_t>((1.0 - kMaskOpacity) * row[x][c] + kMaskOpacity * colour[c]);
      }
    }
  }
}

void label(cv::Mat& picture, const std::string& text, cv::Point corner, const cv::Scalar& colour) {
  constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX, kMargin = 3;
  constexpr double kScale = 0.45;
  int baseline = 0;
  const cv::Size size = cv::getTextSize(text, kFont, kScale, 1, &baseline);
  const int height = size.height + baseline + kMargin;
  corner.x = std::clamp(corner.x, 0, std::max(picture.cols - size.width - 2 * kMargin, 0));
  corner.y = std::clamp(corner.y - height, 0, std::max(picture.rows - height, 0));
  cv::rectangle(picture, {corner.x, corner.y, size.width + 2 * kMargin, height}, colour, cv::FILLED);
  cv::putText(picture, text, {corner.x + kMargin, corner.y + size.height + kMargin / 2 + 1}, kFont, kScale,
              {0, 0, 0}, 1, cv::LINE_AA);
}

}  // namespace

cv::Mat draw_overlay(const cv::Mat& image, const std::vector<nn::Detection>& detections,
                     const std::vector<std::string>& names, float min_score) {
  cv::Mat picture;
  if (image.channels() == 1) {
    cv::cvtColor(image, picture, cv::COLOR_GRAY2BGR);
  } else {
    picture = image.clone();
  }
  const double scale = std::max(1.0, static_cast<double>(kSmallestWidth) / picture.cols);
  if (scale > 1.0) cv::resize(picture, picture, {}, scale, scale, cv::INTER_LINEAR);

  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    if (detections[i].score >= min_score) shown.push_back(i);
  }
  for (const std::size_t i : shown) {
    const cv::Mat1b mask = full_mask(detections[i].mask, image.size(), picture.size());
    blend(picture, mask, instance_colour(i));
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(mask, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    cv::drawContours(picture, outlines, -1, instance_colour(i), 2, cv::LINE_AA);
  }
  // Boxes and labels above all masks, the best scores last and so on top.
  for (auto it = shown.rbegin(); it != shown.rend(); ++it) {
    const nn::Detection& detection = detections[*it];
    const auto pixel = [&](float value) { return static_cast<int>(std::lround(value * scale)); };
    const cv::Point corner(pixel(detection.box.x1), pixel(detection.box.y1));
    cv::rectangle(picture, corner, {pixel(detection.box.x2), pixel(detection.box.y2)}, instance_colour(*it),
                  1);
    label(picture,
          fmt::format("{} {:.2f}", names[static_cast<std::size_t>(detection.label)], detection.score), corner,
          instance_colour(*it));
  }
  return picture;
}

}  // namespace penumbra::apps
