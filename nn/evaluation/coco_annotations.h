// The ground truth of a COCO data set: instances_*.json.
//
//   {"images":      [{"id", "width", "height", "file_name"?}, ...],
//    "categories":  [{"id", "name"?}, ...],
//    "annotations": [{"id", "image_id", "category_id", "bbox": [x, y, width, height], "area",
//                     "iscrowd"?, "segmentation"?, "occlusion"?}, ...]}
//
// Other keys are skipped. "occlusion" is Penumbra's own: the share of the object that something hides, 0..1.
// Format: the COCO data set, "Object Detection".
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include "nn/evaluation/coco_segmentation.h"
#include "nn/evaluation/run_mask.h"

namespace penumbra::nn {

// COCO numbers its images; other data sets name them.
using CocoImageId = std::variant<std::int64_t, std::string>;

struct CocoImage {
  CocoImageId id;
  int width = 0, height = 0;  // pixels
  std::string file_name;      // may be empty
};

struct CocoCategory {
  std::int64_t id = 0;
  std::string name;  // may be empty
};

struct CocoAnnotation {
  std::size_t image = 0, category = 0;  // indices into the lists below
  CocoBox box;
  double area = 0.0;      // pixels, of the segmentation; decides about small, medium and large
  bool is_crowd = false;  // a region of objects that are not told apart
  CocoSegmentation segmentation;
  std::optional<double> occlusion;  // hidden share
};

struct CocoAnnotations {
  std::string file;
  std::vector<CocoImage> images;
  std::vector<CocoCategory> categories;
  std::vector<CocoAnnotation> annotations;  // in the order of the file
  std::unordered_map<CocoImageId, std::size_t> image_of_id;
  std::unordered_map<std::int64_t, std::size_t> category_of_id;
};

// Images and categories alone; the file may have no annotations, as those of COCO's test images.
// Errors as below.
CocoAnnotations read_coco_images(const std::filesystem::path& path);

// Throws InputError, naming file, entry, key, what was expected and what was found, for everything that is
// missing, of another type, not finite or negative where that has no meaning, for ids that stand twice or
// name nothing, and for masks of another size than their image. Time and memory: linear in the file.
CocoAnnotations read_coco_annotations(const std::filesystem::path& path);

// What the readers of annotations and of results share.
CocoImageId read_image_id(const JsonFields& fields, const char* key);
CocoBox read_coco_box(const JsonFields& fields, const char* key);
// Throws unless a run-length mask has the image's size.
void check_mask_size(const JsonFields& fields, const CocoSegmentation& segmentation, const CocoImage& image);
std::string to_string(const CocoImageId& id);  // as text for messages

}  // namespace penumbra::nn
