// An image with all bits that its file has.
#pragma once

#include "nn/image/image.h"
#include "nn/image/image_container.h"

namespace penumbra::nn {

// Grey or BGR, of 8 bits a channel (`bytes`) or 16 (`words`); the other one is empty.
struct StoredImage {
  ByteImage bytes;
  WordImage words;
  ImageInfo info;

  bool is_wide() const { return bytes.empty(); }
  Size size() const { return is_wide() ? words.size() : bytes.size(); }
  int channels() const { return is_wide() ? words.channels() : bytes.channels(); }
};

}  // namespace penumbra::nn
