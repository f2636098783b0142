// A thing that shows itself by some of its pixels only: the hull of their greatest cluster stands for its
// mask.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "slam/dynamics/instance.h"

namespace penumbra::slam {

// 255 inside the hull of the greatest cluster of pixels; `radius`: pixels up to twice that far apart belong
// together.
cv::Mat1b outline_of_cluster(const cv::Size& image, const std::vector<cv::Point>& pixels, int radius);

// How many of the pixels, some of which may lie outside the image, are inside the outline.
int count_inside(const cv::Mat1b& outline, const std::vector<cv::Point>& pixels);

// An instance without a class: `own` of the pixels inside are its own, `foreign` are not; its score is the
// share of its own. Nothing where it is too small to be anything.
std::optional<Instance> outlined_instance(const cv::Mat1b& outline, int own, int foreign);

}  // namespace penumbra::slam
