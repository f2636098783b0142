// An object instance found in one image, as the SLAM sees it: independent of the network that found it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nn/image/image.h"

namespace penumbra::slam {

struct Instance {
  int class_id = 0;                // number of the class in the detector's own list
  std::string class_name;          // "car", "person", ...
  float score = 0.0F;              // 0..1
  Rect region;                     // pixels of the left image; lies inside the image
  ByteImage mask;                  // size of `region`; 0 outside the object, 255 inside
  std::optional<bool> moves = {};  // whether who found it saw it move, if he could tell

  bool contains(int x, int y) const {
    return region.contains(x, y) && mask.at(x - region.x, y - region.y) != 0;
  }
};

struct FrameFeatures;  // slam/frontend/features/frame_features.h

// What a segmenter sees of a frame. Copies share the pixels, which nobody changes.
struct ImageToSegment {
  int frame = 0;     // its number in the sequence
  ByteImage image;   // 8-bit grey or BGR
  FloatImage depth;  // of the image's size: metres along z, 0 where unknown; empty for cameras without depth
  std::shared_ptr<const FrameFeatures> features = {};  // that were found in it, where they are known
};

// Finds the instances of an image.
using Segmenter = std::function<std::vector<Instance>(const ImageToSegment& image)>;

}  // namespace penumbra::slam
