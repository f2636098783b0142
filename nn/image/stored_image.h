// An image with all bits that its file has.
#pragma once

#include <opencv2/core.hpp>

#include "nn/image/image_container.h"

namespace penumbra::nn {

struct StoredImage {
  cv::Mat pixels;  // grey or BGR, of 8 or 16 bits a channel
  ImageInfo info;
};

}  // namespace penumbra::nn
