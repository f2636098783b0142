// Finds a patch in another image to a fraction of a pixel.
//
// T: the patch's inner 11 x 11 pixels, drawn `ratio` times as large; R: the image around p. Both are compared
// without their mean brightness and contrast, so that exposure and shade do not matter:
//
//   minimise over p   sum ( kappa (R(p + x) - mean R) - (T(x) - mean T) )^2,   kappa^2 = var T / var R
//   p <- p - H^-1 sum g (kappa R(p + x) - T(x)),   H = sum g g^T,   g = slope of T less its mean
//
// The slopes are those of the patch, so H is inverted once (inverse composition). About 2 microseconds.
// Source: Lucas, Kanade (1981); Baker, Matthews, Lucas-Kanade 20 Years On (IJCV 2004), section 3.2.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "nn/image/image.h"
#include "slam/frontend/features/patch.h"

namespace penumbra::slam {

struct PatchAlignmentSettings {
  int iterations = 8;              // at most
  float farthest = 2.0F;           // pixels from the start: beyond, it is another corner
  float least_correlation = 0.8F;  // normalised, at the end
  float least_curvature = 1.0F;    // smaller eigenvalue of H over the number of pixels: grey values^2
};

// Sizes by which a patch can be drawn.
inline constexpr float kSmallestPatchRatio = 0.86F, kLargestPatchRatio = 1.5F;

// Position of the patch's middle in `image`, pixels; nothing where the patch has too little structure or is
// not there, or where the window leaves the image or `ratio` its range.
std::optional<Eigen::Vector2f> align_patch(const Patch& patch, float ratio, const ByteView& image,
                                           const Eigen::Vector2f& start,
                                           const PatchAlignmentSettings& settings = {});

}  // namespace penumbra::slam
