// What a detector found in a COCO data set: the results format.
//
//   [{"image_id", "category_id", "score", "bbox": [x, y, width, height]?, "segmentation"?}, ...]
//
// An entry has a box (not []), a segmentation or both. Format: the COCO data set, "Results Format".
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nn/evaluation/coco_annotations.h"
#include "nn/evaluation/coco_segmentation.h"
#include "nn/models/instance_segmenter.h"

namespace penumbra::nn {

struct CocoResult {
  std::size_t image = 0, category = 0;  // indices into the lists of the annotations
  double score = 0.0;
  CocoBox box;        // of the segmentation where the entry has none
  double area = 0.0;  // pixels, decides about small, medium and large; see CocoRules
  CocoSegmentation segmentation;
};

// Where the COCO API's numbers are not what its description says.
enum class CocoRules {
  // The API's numbers. The first entry of the results decides for all whether boxes or masks give the area
  // (for
  // masks too), and an object with the id 0 is never found.
  official,
  // Each entry's own box, or else its mask, gives its area; an id is a name.
  sensible
};

struct CocoResults {
  std::string file;
  std::vector<CocoResult> results;  // in the order of the file
  CocoProblems problems;
  std::size_t of_unknown_categories = 0;  // left out
  std::size_t with_boxes = 0;             // entries that have a box
  bool first_has_box = false;
};

// Results for images and categories of `annotations`; those of categories that it does not have are left out,
// as the API passes over them. Throws InputError as read_coco_annotations does; an image that the annotations
// do not have is one too. Time and memory: linear in the file.
CocoResults read_coco_results(const std::filesystem::path& path, const CocoAnnotations& annotations,
                              CocoRules rules = CocoRules::official);

// Collects detections and writes them as a results file, one entry a line.
class CocoResultsWriter {
 public:
  void add(const CocoImageId& image, std::int64_t category_id, const Detection& detection, int image_width,
           int image_height);
  std::size_t size() const { return size_; }
  // Throws Error where the file cannot be written.
  void write(const std::filesystem::path& path) const;

 private:
  std::string entries_;
  std::size_t size_ = 0;
};

}  // namespace penumbra::nn
