#include "apps/view/frame_picture.h"

#include <algorithm>
#include <cmath>

#include "nn/image/colour.h"
#include "nn/image/drawing.h"
#include "nn/image/resize.h"

namespace penumbra::apps {

namespace {

constexpr int kWidth = 480;  // pixels

constexpr double kMaskOpacity = 0.4;
constexpr double kHidden = 0.6;  // an object that shows less of itself counts as occluded
constexpr Bgr kMoving{44, 55, 209}, kOccluded{40, 140, 240}, kStill{190, 140, 60}, kFixed{150, 150, 60};

// The masks of what the keyframe showed, in the colour of their state.
void draw_masks(const std::vector<slam::InstanceSighting>& sightings, double scale, ByteImage& picture) {
  for (const slam::InstanceSighting& seen : sightings) {
    const Bgr colour = seen.state == slam::MotionState::moving  ? kMoving
                       : seen.visible_share < kHidden           ? kOccluded
                       : seen.state == slam::MotionState::still ? kStill
                                                                : kFixed;
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        const int column = static_cast<int>(x / scale), row = static_cast<int>(y / scale);
        if (!seen.region.contains(column, row)) continue;
        // The mask may be smaller than its region.
        if (seen.mask.at((column - seen.region.x) * seen.mask.width() / seen.region.width,
                         (row - seen.region.y) * seen.mask.height() / seen.region.height) == 0)
          continue;
        std::uint8_t* pixel = &picture.at(x, y);
        for (std::size_t c = 0; c < 3; ++c) {
          const double mixed = (1.0 - kMaskOpacity) * pixel[c] + kMaskOpacity * colour[c];
          pixel[c] = static_cast<std::uint8_t>(std::lround(mixed));
        }
      }
    }
  }
}

}  // namespace

ByteImage draw_frame(const ByteImage& left, const slam::FrameView& view) {
  const double scale = static_cast<double>(kWidth) / left.width();
  const int height = std::max(1, static_cast<int>(std::lround(left.height() * scale)));
  ByteImage picture = resize_area(with_channels(left, 3), {kWidth, height});
  draw_masks(view.sightings, scale, picture);
  for (const slam::FrameView::Feature& feature : view.features) {
    const Bgr colour = feature.movable ? kMoving : feature.in_map ? Bgr{87, 200, 42} : Bgr{70, 190, 215};
    draw_disc(picture, {feature.u * scale, feature.v * scale}, 1.5, colour);
  }
  return picture;
}

}  // namespace penumbra::apps
