#include "apps/brain/landmark_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/network/overlay.h"
#include "nn/image/drawing.h"

namespace penumbra::apps {

namespace {

constexpr Bgr kFeatureColour{80, 220, 80};
constexpr double kFeatureRadius = 2.5;  // pixels of the picture
constexpr double kWidestLine = 4.0;
constexpr std::size_t kMostNames = 10;  // more would lie on each other

}  // namespace

ByteImage landmark_picture(const ByteImage& image, const slam::brain::Landmarks& landmarks,
                           const slam::Features& features) {
  double scale = 1.0;
  ByteImage above = readable_picture(image, scale);
  ByteImage below = above.clone();
  // The least interesting first, so that the others lie on top.
  for (auto it = landmarks.rbegin(); it != landmarks.rend(); ++it) {
    const Bgr colour = instance_colour(static_cast<std::size_t>(it->landmark_class));
    draw_box(above, {it->x0 * scale, it->y0 * scale}, {it->x1 * scale, it->y1 * scale}, colour,
             1.0 + (kWidestLine - 1.0) * static_cast<double>(it->interest));
  }
  for (std::size_t i = std::min(landmarks.size(), kMostNames); i-- > 0;) {
    const slam::brain::Landmark& named = landmarks[i];
    const char* name = name_of(static_cast<slam::brain::LandmarkClass>(named.landmark_class));
    draw_label(above, fmt::format("{} {:.2f}", name, named.interest),
               static_cast<int>(std::lround(named.x0 * scale)),
               static_cast<int>(std::lround(named.y0 * scale)),
               instance_colour(static_cast<std::size_t>(named.landmark_class)));
  }
  for (const slam::Keypoint& keypoint : features.keypoints)
    draw_disc(below, {keypoint.u * scale, keypoint.v * scale}, kFeatureRadius, kFeatureColour);
  ByteImage picture(above.width(), 2 * above.height(), 3);
  std::copy_n(above.data(), above.elements(), picture.data());
  std::copy_n(below.data(), below.elements(), picture.row(above.height()));
  return picture;
}

}  // namespace penumbra::apps
