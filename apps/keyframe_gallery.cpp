#include "apps/keyframe_gallery.h"

#include <fmt/core.h>

#include <map>
#include <opencv2/imgproc.hpp>

#include "nn/base/error.h"
#include "nn/io/image_file.h"

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

cv::Mat3b draw(const cv::Mat& left, const slam::KeyFrame& keyframe,
               const std::vector<slam::InstanceSighting>& sightings) {
  const double scale = static_cast<double>(kWidth) / left.cols;
  cv::Mat bgr = left;
  if (left.channels() == 1) cv::cvtColor(left, bgr, cv::COLOR_GRAY2BGR);
  cv::Mat3b picture;
  cv::resize(bgr, picture, {kWidth, std::max(1, cvRound(left.rows * scale))}, 0, 0, cv::INTER_AREA);
  draw_masks(sightings, scale, picture);
  const slam::FrameFeatures& features = *keyframe.features;
  for (int i = 0; i < features.size(); ++i) {
    const cv::Scalar colour = features.is_movable(i) ? cv::Scalar(44, 55, 209)
                              : keyframe.points[static_cast<std::size_t>(i)] != nullptr
                                  ? cv::Scalar(87, 200, 42)
                                  : cv::Scalar(70, 190, 215);
    const slam::Keypoint& k = features.keypoint(i);
    cv::circle(picture, {cvRound(k.u * scale), cvRound(k.v * scale)}, 1, colour, cv::FILLED, cv::LINE_AA);
  }
  return picture;
}

}  // namespace

void write_keyframe_gallery(const std::filesystem::path& folder, const slam::StereoDataset& dataset,
                            const slam::Slam& slam, int most) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::map<int, int> row_of;  // frame number -> place in the dataset
  for (std::size_t i = 0; i < slam.results().size(); ++i)
    row_of[slam.results()[i].index] = static_cast<int>(i);
  const auto& keyframes = slam.map().keyframes();
  const int count = static_cast<int>(keyframes.size()), shown = std::min(count, most);
  for (int n = 0; n < shown; ++n) {
    const slam::KeyFrame& keyframe =
        *keyframes[static_cast<std::size_t>(n) * static_cast<std::size_t>(count) /
                   static_cast<std::size_t>(shown)];
    const auto row = row_of.find(keyframe.frame_index);
    if (row == row_of.end() || slam.is_loaded(keyframe)) continue;
    const auto seen = slam.sightings().find(keyframe.frame_index);
    const auto sightings =
        seen != slam.sightings().end() ? seen->second : std::vector<slam::InstanceSighting>{};
    try {
      nn::write_image(folder / fmt::format("{:06d}.jpg", keyframe.frame_index),
                      draw(dataset.load(row->second).left, keyframe, sightings));
    } catch (const InputError&) {
      continue;
    }
  }
}

}  // namespace penumbra::apps
