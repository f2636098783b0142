// Spreads corners evenly over an image: of many candidates about `wanted` are kept, the strongest of each
// region.
//
// The region is split into four as long as fewer than `wanted` regions hold corners, always the region with
// the most corners first; then the strongest corner of each region is kept. O(n log n) for n candidates.
// Source: the distribution idea of ORB-SLAM (Mur-Artal et al., T-RO 2015, section IV-A), own formulation.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace penumbra::slam {

// `corners`: positions inside `region`, with a response; returns at most max(wanted, number of starting
// squares) of them, in an order that depends on the input only. Equal responses: the first one of the input
// is kept.
std::vector<cv::KeyPoint> spread_corners(std::vector<cv::KeyPoint> corners, const cv::Rect2f& region,
                                         int wanted);

}  // namespace penumbra::slam
