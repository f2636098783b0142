// Ground truth as COCO instances JSON, which `penumbra eval-coco` and pycocotools read.
//
//   images       {id, file_name (relative to the output folder), width, height}; ids count from 1
//   categories   those of the world's catalogue, such as 1 person, 2 cyclist, 3 car, 4 truck, 5 sign: the
//                numbers of ObjectClass
//   annotations  {id, image_id, category_id, iscrowd 0,
//                 bbox, area, segmentation:                 of the visible mask (compressed run lengths)
//                 amodal_bbox, amodal_segmentation:         of the whole object inside the image
//                 occlusion: hidden share of the amodal mask, 0..1
//                 instance_id: as in instances/NNNNNN.png,  moving: bool}
//
// Left out are objects with fewer than kMinVisiblePixels visible pixels and signs seen from behind. COCO has
// no other way to say so: its evaluation takes only `iscrowd` for "ignore", which means something else.
#pragma once

#include <string>
#include <vector>

#include "nn/image/image.h"
#include "slam/world/instance_masks.h"

namespace penumbra::slam::synthetic {

constexpr int kMinVisiblePixels = 20;

class CocoWriter {
 public:
  explicit CocoWriter(const Size& size, const Catalogue& catalogue = kStreetCatalogue)
      : size_(size), catalogue_(catalogue) {}

  void add(const std::string& file_name, const std::vector<InstanceMasks>& instances);
  // The whole file. About 700 bytes an annotation.
  std::string finish() const;

 private:
  Size size_;
  Catalogue catalogue_;
  int images_ = 0, annotations_ = 0;
  std::string image_text_, annotation_text_;
};

}  // namespace penumbra::slam::synthetic
