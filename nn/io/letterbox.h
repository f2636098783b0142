// From an image file's pixels to YOLO's input: resized with its aspect kept, framed in grey.
//
//   r = min(size / H, size / W);  H' = round(H r), W' = round(W r)
//   the frame fills both extents up to the next multiple of `stride`, half of it on each side (the odd pixel
//   below and right);  x = rgb / 255
//
// The image is resized bilinearly without antialiasing and rounded to 8 bits, with the whole-number
// arithmetic and the results of OpenCV's cv::INTER_LINEAR, on whose images YOLOv5 was trained:
//   weights a, b of the 2 columns and 2 rows: multiples of 2^-11;  h = a_0 x_0 + a_1 x_1
//   y = ( (b_0 (h_0 >> 4) >> 16) + (b_1 (h_1 >> 4) >> 16) + 2 ) >> 2
// The frame is no larger than the stride demands ("rectangular" or "auto" letterbox).
// Source: Jocher et al., YOLOv5, letterbox with auto padding.
#pragma once

#include "nn/image/image.h"
#include "nn/tensor/feature_map.h"

namespace penumbra::nn {

struct Letterbox {
  int size = 640;   // pixels of the longer side
  int stride = 32;  // the map's extents are multiples of it
  int fill = 114;   // grey level of the frame
};

// Where the image lies on the map, pixels.
struct LetterboxFrame {
  int map_height = 0, map_width = 0;
  int left = 0, top = 0, width = 0, height = 0;  // the part that shows the image
  float scale = 1.0F;                            // map pixels per image pixel: r
};

// Both throw InputError unless `image` is 8-bit grey or BGR and not empty.
LetterboxFrame letterbox_frame(const ByteView& image, const Letterbox& letterbox);

// The map [1, 3, H_padded, W_padded] in blocks of 4; `border` is its zero border.
FeatureMap letterbox_image(const ByteView& image, const Letterbox& letterbox, Arena& arena, int border);

}  // namespace penumbra::nn
