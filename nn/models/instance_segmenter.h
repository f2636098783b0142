// What every network that finds object instances in images looks like from outside.
#pragma once

#include <string>
#include <vector>

#include "nn/image/image.h"
#include "nn/layers/box.h"
#include "nn/layers/mask_paste.h"
#include "nn/tensor/arena.h"

namespace penumbra::nn {

// An object instance found in an image.
struct Detection {
  Box box;  // pixels of the image
  float score = 0.0F;
  int label =
      0;      // class number; 0, background, does not occur. Networks of COCO's classes use COCO's numbers
  Mask mask;  // empty where the network finds boxes only
};

class InstanceSegmenter {
 public:
  InstanceSegmenter() = default;
  InstanceSegmenter(const InstanceSegmenter&) = delete;
  InstanceSegmenter& operator=(const InstanceSegmenter&) = delete;
  virtual ~InstanceSegmenter() = default;

  virtual std::string name() const = 0;  // for messages: "Mask R-CNN ResNet-50 FPN"
  // One more than the highest label: the background counts, and so do gaps in COCO's numbering.
  virtual int classes() const = 0;
  virtual bool has_masks() const = 0;
  // Whether the network itself has an output for the background, which lists of its class names then count.
  virtual bool has_background() const = 0;

  // Detections in order of falling score. `image` is 8-bit grey or BGR of any size, not empty (else
  // InputError). Activations live in `arena`, nothing in the network changes: threads may share a network if
  // each has an arena of its own.
  // `detections` is overwritten, its memory used again: from the second image of a shape on nothing else is
  // allocated.
  virtual void detect(const ByteView& image, Arena& arena, std::vector<Detection>& detections) const = 0;
  std::vector<Detection> detect(const ByteView& image, Arena& arena) const {
    std::vector<Detection> detections;
    detect(image, arena, detections);
    return detections;
  }

  // The same in the network's own arena; for one thread at a time.
  std::vector<Detection> operator()(const ByteView& image) { return detect(image, arena_); }
  const Arena& arena() const { return arena_; }

 private:
  Arena arena_;
};

}  // namespace penumbra::nn
