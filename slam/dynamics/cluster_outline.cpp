#include "slam/dynamics/cluster_outline.h"

#include <algorithm>

namespace penumbra::slam {

namespace {

constexpr int kSmallestArea = 16;  // pixels

}  // namespace

ByteImage outline_of_cluster(const Size& image, const std::vector<Pixel>& pixels, int radius) {
  ByteImage dots = ByteImage::filled(image.width, image.height, 0);
  ByteImage outline = dots.clone();
  if (pixels.empty()) return outline;
  for (const Pixel& pixel : pixels) fill_disc(dots, pixel, radius, 255);
  Image<std::int32_t> labels;
  std::vector<int> sizes(static_cast<std::size_t>(connected_components(dots, labels)) + 1, 0);
  const auto label_at = [&](const Pixel& p) {
    return labels.at(std::clamp(p.x, 0, image.width - 1), std::clamp(p.y, 0, image.height - 1));
  };
  for (const Pixel& pixel : pixels) ++sizes[static_cast<std::size_t>(label_at(pixel))];
  const auto greatest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  std::vector<Pixel> cluster;
  for (const Pixel& pixel : pixels) {
    if (label_at(pixel) == greatest) cluster.push_back(pixel);
  }
  fill_convex(outline, convex_hull(std::move(cluster)), 255);
  return outline;
}

int count_inside(const ByteImage& outline, const std::vector<Pixel>& pixels) {
  const Rect all{0, 0, outline.width(), outline.height()};
  return static_cast<int>(std::count_if(pixels.begin(), pixels.end(), [&](const Pixel& p) {
    return all.contains(p.x, p.y) && outline.at(p.x, p.y) != 0;
  }));
}

std::optional<Instance> outlined_instance(const ByteImage& outline, int own, int foreign) {
  Instance instance;
  instance.region = bounds_of(outline);
  if (instance.region.area() < kSmallestArea) return std::nullopt;
  instance.mask = ByteImage::copy_of(outline.region(instance.region));
  instance.score = static_cast<float>(own) / static_cast<float>(own + foreign);
  return instance;
}

}  // namespace penumbra::slam
