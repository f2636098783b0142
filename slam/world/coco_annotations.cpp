#include "slam/world/coco_annotations.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "nn/evaluation/coco_rle.h"

namespace penumbra::slam::synthetic {

namespace {

using Json = nlohmann::ordered_json;

Json box_of(const nn::Mask& mask) { return {mask.x, mask.y, mask.width, mask.height}; }

Json runs_of(const nn::Mask& mask, const Size& size) {
  return {{"size", {size.height, size.width}},
          {"counts", nn::encode_runs(nn::mask_runs(mask, size.width, size.height))}};
}

void append(std::string& list, const Json& entry) {
  list += list.empty() ? "\n  " : ",\n  ";
  list += entry.dump();
}

}  // namespace

void CocoWriter::add(const std::string& file_name, const std::vector<InstanceMasks>& instances) {
  append(image_text_,
         {{"id", ++images_}, {"file_name", file_name}, {"width", size_.width}, {"height", size_.height}});
  for (const InstanceMasks& masks : instances) {
    if (masks.visible_area < kMinVisiblePixels || !masks.faces_camera) continue;
    append(annotation_text_, {{"id", ++annotations_},
                              {"image_id", images_},
                              {"category_id", static_cast<int>(masks.object_class)},
                              {"bbox", box_of(masks.visible)},
                              {"area", masks.visible_area},
                              {"iscrowd", 0},
                              {"segmentation", runs_of(masks.visible, size_)},
                              {"amodal_bbox", box_of(masks.whole)},
                              {"amodal_segmentation", runs_of(masks.whole, size_)},
                              {"occlusion", std::round(1e4 * masks.occlusion()) / 1e4},
                              {"instance_id", masks.instance},
                              {"moving", masks.moving}});
  }
}

std::string CocoWriter::finish() const {
  std::string categories;
  for (const ObjectClass object_class : catalogue_.classes) {
    append(categories, {{"id", static_cast<int>(object_class)}, {"name", name_of(object_class)}});
  }
  return "{\"info\": {\"description\": \"" + std::string(catalogue_.description) + "\"},\n\"images\": [" +
         image_text_ + "],\n\"categories\": [" + categories + "],\n\"annotations\": [" + annotation_text_ +
         "]}\n";
}

}  // namespace penumbra::slam::synthetic
