// Draws what a network found onto its image: masks, boxes, names and scores.
#pragma once

#include <string>
#include <vector>

#include "nn/image/drawing.h"
#include "nn/image/image.h"
#include "nn/models/mask_rcnn.h"

namespace penumbra::apps {

// A BGR picture of the image's size, or of 640 pixels width where that is smaller, so that the text can be
// read. Detections below `min_score` are left out. `names` has one name a class.
ByteImage draw_overlay(const ByteImage& image, const std::vector<nn::Detection>& detections,
                       const std::vector<std::string>& names, float min_score);

// What draw_overlay is made of, for other pictures of things in images.
// The image in colour, enlarged to that least width; `scale`: its pixels per pixel of the image.
ByteImage readable_picture(const ByteImage& image, double& scale);
// A colour of its own for every instance: hues a golden angle apart stay far from each other.
Bgr instance_colour(std::size_t i);
// On a box of `colour` above the corner (x, y), moved to where it lies inside the picture.
void draw_label(ByteImage& picture, const std::string& text, int x, int y, const Bgr& colour);

}  // namespace penumbra::apps
