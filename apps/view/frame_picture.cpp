#include "apps/view/frame_picture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace penumbra::apps {

namespace {

constexpr int kWidth = 480;  // pixels

constexpr double kMaskOpacity = 0.4;
constexpr double kHidden = 0.6;  // an object that shows less of itself counts as occluded
const cv::Vec3b kMoving(44, 55, 209), kOccluded(40, 140, 240), kStill(190, 140, 60), kFixed(150, 150, 60);

// The masks of what the keyframe showed, in the colour of their state.
void draw_masks(const std::vector<slam::InstanceSighting>& sightings, double scale, cv::Mat3b& picture) {
  for (const slam::InstanceSighting& seen : sightings) {
    const cv::Vec3b colour = seen.state == slam::MotionState::moving  ? kMoving
                             : seen.visible_share < kHidden           ? kOccluded
                             : seen.state == slam::MotionState::still ? kStill
                                                                      : kFixed;
    for (int y = 0; y < picture.rows; ++y) {
      for (int x = 0; x < picture.cols; ++x) {
        const cv::Point pixel(static_cast<int>(x / scale), static_cast<int>(y / scale));
        if (!seen.region.contains(pixel)) continue;
        const cv::Point inside = pixel - seen.region.tl();  // the mask may be smaller than its region
        if (seen.mask(inside.y * seen.mask.rows / seen.region.height,
                      inside.x * seen.mask.cols / seen.region.width) == 0)
          continue;
        picture(y, x) = (1.0 - kMaskOpacity) * picture(y, x) + kMaskOpacity * colour;
      }
    }
  }
}

}  // namespace

cv::Mat3b draw_frame(const cv::Mat& left, const slam::FrameView& view) {
  const double scale = static_cast<double>(kWidth) / left.cols;
  cv::Mat bgr = left;
  if (left.channels() == 1) cv::cvtColor(left, bgr, cv::COLOR_GRAY2BGR);
  cv::Mat3b picture;
  cv::resize(bgr, picture, {kWidth, std::max(1, cvRound(left.rows * scale))}, 0, 0, cv::INTER_AREA);
  draw_masks(view.sightings, scale, picture);
  for (const slam::FrameView::Feature& feature : view.features) {
    const cv::Scalar colour = feature.movable  ? cv::Scalar(44, 55, 209)
                              : feature.in_map ? cv::Scalar(87, 200, 42)
                                               : cv::Scalar(70, 190, 215);
    cv::circle(picture, {cvRound(feature.u * scale), cvRound(feature.v * scale)}, 1, colour, cv::FILLED,
               cv::LINE_AA);
  }
  return picture;
}

}  // namespace penumbra::apps
