#include "slam/dynamics/cluster_outline.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace penumbra::slam {

namespace {

constexpr int kSmallestArea = 16;  // pixels

}  // namespace

cv::Mat1b outline_of_cluster(const cv::Size& image, const std::vector<cv::Point>& pixels, int radius) {
  cv::Mat1b dots(image, std::uint8_t{0}), outline(image, std::uint8_t{0});
  if (pixels.empty()) return outline;
  for (const cv::Point& pixel : pixels) cv::circle(dots, pixel, radius, 255, cv::FILLED);
  cv::Mat1i labels;
  std::vector<int> sizes(static_cast<std::size_t>(cv::connectedComponents(dots, labels)), 0);
  const auto label_at = [&](const cv::Point& p) {
    return labels(std::clamp(p.y, 0, image.height - 1), std::clamp(p.x, 0, image.width - 1));
  };
  for (const cv::Point& pixel : pixels) ++sizes[static_cast<std::size_t>(label_at(pixel))];
  const auto greatest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  std::vector<cv::Point> cluster, hull;
  for (const cv::Point& pixel : pixels) {
    if (label_at(pixel) == greatest) cluster.push_back(pixel);
  }
  cv::convexHull(cluster, hull);
  cv::fillConvexPoly(outline, hull, 255);
  return outline;
}

int count_inside(const cv::Mat1b& outline, const std::vector<cv::Point>& pixels) {
  return static_cast<int>(std::count_if(pixels.begin(), pixels.end(), [&](const cv::Point& p) {
    return cv::Rect({}, outline.size()).contains(p) && outline(p) != 0;
  }));
}

std::optional<Instance> outlined_instance(const cv::Mat1b& outline, int own, int foreign) {
  Instance instance;
  instance.region = cv::boundingRect(outline);
  if (instance.region.area() < kSmallestArea) return std::nullopt;
  instance.mask = outline(instance.region).clone();
  instance.score = static_cast<float>(own) / static_cast<float>(own + foreign);
  return instance;
}

}  // namespace penumbra::slam
