#include "slam/dynamics/cluster_outline.h"

#include <random>

#include "tests/support/image_cases.h"

namespace penumbra::slam {
namespace {

// The definition, on the whole image.
ByteImage naive_outline(const Size& image, const std::vector<Pixel>& pixels, int radius) {
  ByteImage dots = ByteImage::filled(image.width, image.height, 0), outline = dots.clone();
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

TEST(ClusterOutline, IsThatOfTheDefinition) {
  std::mt19937 random(1);
  for (int n = 0; n < 300; ++n) {
    const Size image{static_cast<int>(20 + random() % 150), static_cast<int>(20 + random() % 90)};
    std::vector<Pixel> pixels;
    const int spread = static_cast<int>(5 + random() % 60);
    for (unsigned k = random() % 30; k > 0; --k) {
      // Some beyond the border.
      const int x = static_cast<int>(random() % std::uint32_t(image.width)),
                y = static_cast<int>(random() % std::uint32_t(image.height));
      pixels.push_back({x + static_cast<int>(random() % std::uint32_t(spread)) - 2, y});
    }
    const int radius = static_cast<int>(random() % 12);
    EXPECT_TRUE(
        test::same_pixels(outline_of_cluster(image, pixels, radius), naive_outline(image, pixels, radius)))
        << n;
  }
}

}  // namespace
}  // namespace penumbra::slam
