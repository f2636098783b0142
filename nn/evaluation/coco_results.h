// What a detector found in a COCO data set: the results format.
//
//   [{"image_id", "category_id", "score", "bbox": [x, y, width, height]?, "segmentation"?}, ...]
//
// An entry has a box, a segmentation or both. Format: the COCO data set, "Results Format".
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
  CocoBox box;  // of the segmentation where the entry has none
  // Pixels, decides about small, medium and large: of the box where the entry has one, of the segmentation
  // otherwise. (The COCO API's rule, for masks too.)
  double area = 0.0;
  CocoSegmentation segmentation;
};

struct CocoResults {
  std::string file;
  std::vector<CocoResult> results;  // in the order of the file
};

// Results for images and categories of `annotations`. Throws InputError as read_coco_annotations does; an
// image or category that the annotations do not have is one too. Time and memory: linear in the file.
CocoResults read_coco_results(const std::filesystem::path& path, const CocoAnnotations& annotations);

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
