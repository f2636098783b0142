// What the plots have in common: colours, text and the scale they are drawn at.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace penumbra::slam {

// Everything is drawn at twice the size and halved at the end: smoother than OpenCV's own anti-aliasing.
inline constexpr int kSupersampling = 2;

// BGR. Plots take their colours from Okabe and Ito's palette, told apart by colour-blind readers too.
inline const cv::Scalar kPaper(255, 255, 255), kInk(45, 45, 45), kFaintInk(120, 120, 120),
    kGrid(232, 232, 232);

// Final pixels to those of the canvas.
cv::Point scaled(const cv::Point2d& point);

enum class Anchor { left, centre, right };

// Text whose baseline starts, is centred or ends at `position` (final pixels); `height` of capitals likewise.
void draw_text(cv::Mat& canvas, const std::string& text, cv::Point2d position, double height, Anchor anchor,
               const cv::Scalar& colour, bool bold = false);
// Its width in final pixels.
int text_width(const std::string& text, double height);

// 1, 2 or 5 times a power of ten, at least `smallest`: the distance of grid lines.
double round_step(double smallest);

}  // namespace penumbra::slam
