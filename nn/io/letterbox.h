// From an image file's pixels to YOLO's input: resized with its aspect kept, framed in grey.
//
//   r = min(size / H, size / W);  H' = round(H r), W' = round(W r)
//   the frame fills both extents up to the next multiple of `stride`, half of it on each side (the odd pixel
//   below and right);  x = rgb / 255
//
// The image is resized bilinearly without antialiasing (cv::INTER_LINEAR, 8-bit), as YOLOv5 was trained; the
// frame is no larger than the stride demands ("rectangular" or "auto" letterbox).
// Source: Jocher et al., YOLOv5, letterbox with auto padding.
#pragma once

#include <opencv2/core.hpp>

#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

struct Letterbox {
  int size = 640;   // pixels of the longer side
  int stride = 32;  // the map's extents are multiples of it
  int fill = 114;   // grey level of the frame
};

struct LetterboxedImage {
  FeatureMap map;                                // [1, 3, H_padded, W_padded], blocks of 4
  int left = 0, top = 0, width = 0, height = 0;  // the part of the map that shows the image, pixels
  float scale = 1.0F;                            // map pixels per image pixel: r
};

// `image` is 8-bit grey or BGR, not empty. `border` is the map's zero border.
LetterboxedImage letterbox_image(const cv::Mat& image, const Letterbox& letterbox, Arena& arena, int border);

}  // namespace penumbra::nn
