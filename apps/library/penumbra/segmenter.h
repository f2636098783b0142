// Finds things in images: Mask R-CNN, YOLOv5 or AFNET, by the weights that are given.
//
//   penumbra::Segmenter segmenter("weights.safetensors");
//   for (const penumbra::Instance& thing : segmenter.find(image)) ...
//
// Weights: safetensors or PyTorch checkpoints (docs/formats.md); nothing in them is executed. One thread at a
// time calls a Segmenter. Errors are std::runtime_error.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "penumbra/export.h"
#include "penumbra/image.h"

namespace penumbra {

struct Instance {
  int class_id = 0;
  std::string class_name = {};
  float score = 0.0F;                                // 0..1
  float x1 = 0.0F, y1 = 0.0F, x2 = 0.0F, y2 = 0.0F;  // its box, pixels
  int mask_x = 0, mask_y = 0;                        // the mask's upper left pixel in the image
  int mask_width = 0, mask_height = 0;               // 0: the network draws boxes alone
  std::vector<std::uint8_t> mask = {};               // row by row, 1 on the thing, else 0
};

struct SegmenterOptions {
  float least_score = 0.5F;
  std::string classes = {};  // a file of class names, one a line; empty: as the weights say, or COCO's
};

class PENUMBRA_API Segmenter {
 public:
  explicit Segmenter(const std::string& weights, SegmenterOptions options = {});
  ~Segmenter();
  Segmenter(Segmenter&&) noexcept;
  Segmenter& operator=(Segmenter&&) noexcept;

  std::string network() const;  // such as "Mask R-CNN ResNet-50 FPN"
  bool has_masks() const;
  // In the order of falling scores. `image`: grey or colour, of any size.
  std::vector<Instance> find(const ImageRef& image);

 private:
  struct Loaded;
  std::unique_ptr<Loaded> loaded_;
};

}  // namespace penumbra
