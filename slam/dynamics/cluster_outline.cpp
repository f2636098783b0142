#include "slam/dynamics/cluster_outline.h"

#include <algorithm>

namespace penumbra::slam {

namespace {

constexpr int kSmallestArea = 16;  // pixels

// The part of the image that holds all discs around the pixels, those outside taken to its border. It begins
// at an even place: connected_components numbers by blocks of two.
Rect part_around(const Size& image, const std::vector<Pixel>& pixels, int radius) {
  int left = image.width - 1, top = image.height - 1, right = 0, bottom = 0;
  for (const Pixel& p : pixels) {
    const int x = std::clamp(p.x, 0, image.width - 1), y = std::clamp(p.y, 0, image.height - 1);
    left = std::min(left, x);
    right = std::max(right, x);
    top = std::min(top, y);
    bottom = std::max(bottom, y);
  }
  left = std::max(0, left - radius) & ~1;
  top = std::max(0, top - radius) & ~1;
  return {left, top, std::min(image.width, right + radius + 1) - left,
          std::min(image.height, bottom + radius + 1) - top};
}

}  // namespace

ByteImage outline_of_cluster(const Size& image, const std::vector<Pixel>& pixels, int radius) {
  ByteImage outline = ByteImage::filled(image.width, image.height, 0);
  if (pixels.empty()) return outline;
  const Rect part = part_around(image, pixels, radius);
  ByteImage dots = ByteImage::filled(part.width, part.height, 0);
  for (const Pixel& pixel : pixels) fill_disc(dots, {pixel.x - part.x, pixel.y - part.y}, radius, 255);
  Image<std::int32_t> labels;
  std::vector<int> sizes(static_cast<std::size_t>(connected_components(dots, labels)) + 1, 0);
  const auto label_at = [&](const Pixel& p) {
    return labels.at(std::clamp(p.x, 0, image.width - 1) - part.x,
                     std::clamp(p.y, 0, image.height - 1) - part.y);
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
