#include "apps/slam/mask_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "nn/image/drawing.h"
#include "nn/image/fast_corners.h"
#include "nn/image/grey.h"
#include "slam/dynamics/rgbd/depth_kmeans.h"

namespace penumbra::apps {

namespace {

constexpr int kGap = 4;  // pixels between pictures
constexpr const char* kPanels[] = {"image", "depth", "repaired", "clusters", "mask", "corners"};
constexpr int kCaption = 18;  // pixels above the pictures
constexpr int kClusters = 8;
constexpr int kFastThreshold = 20;
constexpr Bgr kUnknown = {40, 20, 110}, kTaken = {60, 60, 230}, kKept = {90, 210, 90};
constexpr std::array<Bgr, kClusters> kClusterColours = {{{180, 119, 31},
                                                         {14, 127, 255},
                                                         {44, 160, 44},
                                                         {40, 39, 214},
                                                         {189, 103, 148},
                                                         {75, 86, 140},
                                                         {194, 119, 227},
                                                         {150, 150, 150}}};

Bgr depth_colour(float metres) {
  constexpr float kNearest = 0.6F;  // metres, white
  if (!(metres > 0.0F)) return kUnknown;
  const auto grey = static_cast<std::uint8_t>(std::lround(255.0F * std::min(1.0F, kNearest / metres)));
  return {grey, grey, grey};
}

// The clusters of the depths in the box.
std::vector<slam::DepthCluster> clusters_of(const FloatImage& depth, const Rect& box) {
  slam::DepthHistogram histogram;
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (depth.at(x, y) > 0.0F) histogram.add(depth.at(x, y));
    }
  }
  slam::DepthKmeans kmeans;
  return kmeans.cluster(histogram, kClusters);
}

Bgr cluster_colour(const std::vector<slam::DepthCluster>& clusters, float metres) {
  if (!(metres > 0.0F)) return kUnknown;
  const int bin = slam::DepthHistogram::bin_of(metres);
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    if (bin <= clusters[c].last) return kClusterColours[c];
  }
  return kClusterColours.back();
}

}  // namespace

ByteImage mask_steps(const ByteImage& image, const FloatImage& depth, const FloatImage& repaired,
                     const Rect& box, const slam::ObjectMask& mask) {
  const int panels = static_cast<int>(std::size(kPanels)), from_panel = box.width + kGap;
  ByteImage picture = ByteImage::filled(panels * from_panel - kGap, kCaption + box.height, 255, 3);
  for (int panel = 0; panel < panels; ++panel)
    draw_text(picture, kPanels[panel], {panel * from_panel + 2.0, kCaption - 5.0}, 9.0, {0, 0, 0});
  const std::vector<slam::DepthCluster> clusters = clusters_of(repaired, box);
  const auto draw = [&](int panel, int x, int y, const Bgr& colour) {
    std::copy(colour.begin(), colour.end(), &picture.at(panel * from_panel + x, kCaption + y));
  };
  for (int y = 0; y < box.height; ++y) {
    for (int x = 0; x < box.width; ++x) {
      const int u = box.x + x, v = box.y + y, step = image.channels() == 3 ? 1 : 0;
      const Bgr pixel = {image.at(u, v, 0), image.at(u, v, step), image.at(u, v, 2 * step)};
      Bgr dark = pixel;
      for (std::uint8_t& value : dark) value = static_cast<std::uint8_t>(value / 4);
      draw(0, x, y, pixel);
      draw(1, x, y, depth_colour(depth.at(u, v)));
      draw(2, x, y, depth_colour(repaired.at(u, v)));
      draw(3, x, y, cluster_colour(clusters, repaired.at(u, v)));
      draw(4, x, y, mask.mask.at(x, y) != 0 ? pixel : dark);
      draw(5, x, y, pixel);
    }
  }
  const Rect inside =
      intersection(box, {FastCorners::kRadius, FastCorners::kRadius, image.width() - 2 * FastCorners::kRadius,
                         image.height() - 2 * FastCorners::kRadius});
  if (inside.empty()) return picture;
  FastCorners fast;
  std::vector<Corner> corners;
  fast.measure(to_grey(image), inside, kFastThreshold);
  fast.find(inside, kFastThreshold, corners);
  for (const Corner& corner : corners) {
    const int x = corner.x - box.x, y = corner.y - box.y;
    const Bgr& colour = mask.mask.at(x, y) != 0 ? kTaken : kKept;
    for (int v = std::max(0, y - 1); v <= std::min(box.height - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(box.width - 1, x + 1); ++u) draw(5, u, v, colour);
    }
  }
  return picture;
}

}  // namespace penumbra::apps
