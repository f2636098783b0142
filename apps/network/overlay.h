// Draws what a network found onto its image: masks, boxes, names and scores.
#pragma once

#include <string>
#include <vector>

#include "nn/image/image.h"
#include "nn/models/mask_rcnn.h"

namespace penumbra::apps {

// A BGR picture of the image's size, or of 640 pixels width where that is smaller, so that the text can be
// read. Detections below `min_score` are left out. `names` has one name a class.
ByteImage draw_overlay(const ByteImage& image, const std::vector<nn::Detection>& detections,
                       const std::vector<std::string>& names, float min_score);

}  // namespace penumbra::apps
