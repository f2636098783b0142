// A thing that shows itself by some of its pixels only: the hull of their greatest cluster stands for its
// mask.
#pragma once

#include <optional>
#include <vector>

#include "nn/image/shapes.h"
#include "slam/dynamics/instance.h"

namespace penumbra::slam {

// 255 inside the hull of the greatest cluster of pixels; `radius`: pixels up to twice that far apart belong
// together.
ByteImage outline_of_cluster(const Size& image, const std::vector<Pixel>& pixels, int radius);

// How many of the pixels, some of which may lie outside the image, are inside the outline.
int count_inside(const ByteImage& outline, const std::vector<Pixel>& pixels);

// An instance without a class: `own` of the pixels inside are its own, `foreign` are not; its score is the
// share of its own. Nothing where it is too small to be anything.
std::optional<Instance> outlined_instance(const ByteImage& outline, int own, int foreign);

}  // namespace penumbra::slam
