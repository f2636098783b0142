// Spreads corners evenly over an image: of many candidates about `wanted` are kept, the strongest of each
// region.
//
// The region is split into four as long as fewer than `wanted` regions hold corners, always the region with
// the most corners first; then the strongest corner of each region is kept. O(n log n) for n candidates.
// Source: the distribution idea of ORB-SLAM (Mur-Artal et al., T-RO 2015, section IV-A), own formulation.
#pragma once

#include <vector>

#include "nn/image/fast_corners.h"

namespace penumbra::slam {

// `corners`: inside `region`; returns at most max(wanted, number of starting
// squares) of them, in an order that depends on the input only. Equal scores: the first one of the input
// is kept.
std::vector<Corner> spread_corners(std::vector<Corner> corners, const Rect& region, int wanted);

}  // namespace penumbra::slam
