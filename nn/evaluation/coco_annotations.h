// The ground truth of a COCO data set: instances_*.json.
//
//   {"images":      [{"id", "width"?, "height"?, "file_name"?}, ...],
//    "categories":  [{"id", "name"?}, ...],
//    "annotations": [{"id", "image_id", "category_id", "bbox"?: [x, y, width, height], "area",
//                     "iscrowd"?, "segmentation"?, "occlusion"?}, ...]}
//
// Boxes are needed where boxes are evaluated; segmentations and sizes where masks are. Other keys are
// skipped. "occlusion" is Penumbra's own: the share of the object that something hides, 0..1. Format: the
// COCO data set, "Object Detection".
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include "nn/base/error.h"
#include "nn/evaluation/coco_segmentation.h"
#include "nn/evaluation/run_mask.h"

namespace penumbra::nn {

// COCO numbers its images; other data sets name them.
using CocoImageId = std::variant<std::int64_t, std::string>;

struct CocoImage {
  CocoImageId id;
  int width = 0, height = 0;  // pixels; 0 where the file does not say
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
  bool has_id_0 = false;            // which the COCO API takes for "not found"
};

// What is wrong with the first entry whose box or mask could not be read: an error where those are evaluated.
struct CocoProblems {
  std::optional<InputError> boxes, masks;
};

struct CocoAnnotations {
  std::string file;
  std::vector<CocoImage> images;
  std::vector<CocoCategory> categories;
  std::vector<CocoAnnotation> annotations;  // in the order of the file
  CocoProblems problems;
  // Annotations of images and categories that the file does not list; the COCO API passes over them, too.
  std::size_t of_unknown_images = 0, of_unknown_categories = 0;
  std::unordered_map<CocoImageId, std::size_t> image_of_id;
  std::unordered_map<std::int64_t, std::size_t> category_of_id;
};

// Images and categories alone; the file may have no annotations, as those of COCO's test images.
// Errors as below.
CocoAnnotations read_coco_images(const std::filesystem::path& path);

// Throws InputError, naming file, entry, key, what was expected and what was found, for everything that is
// missing, of another type, not finite or negative where that has no meaning, and for ids that stand twice;
// for missing boxes and faulty masks only once they are evaluated (CocoProblems). Time and memory: linear in
// the file.
CocoAnnotations read_coco_annotations(const std::filesystem::path& path);

// What the readers of annotations and of results share.
CocoImageId read_image_id(const JsonFields& fields, const char* key);
bool has_coco_box(const JsonFields& fields, const char* key);  // present, not null and not []
CocoBox read_coco_box(const JsonFields& fields, const char* key);
// The segmentation of an object on `image`; what is wrong with it, or with the image's size, goes to
// `problem` where that is empty, and none is returned.
CocoSegmentation read_coco_mask(const JsonFields& fields, const CocoImage& image,
                                std::optional<InputError>& problem);
std::string to_string(const CocoImageId& id);  // as text for messages

}  // namespace penumbra::nn
