// Readers of COCO's JSON: annotations of a data set, results of a detector.
#include <cmath>

#include "nn/evaluation/coco_annotations.h"
#include "nn/evaluation/coco_results.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/target.h"

namespace penumbra::fuzz {

bool read_coco_annotations(std::string_view bytes) {
  const MemoryFile file(bytes);
  is_read([&] { nn::read_coco_images(file.path()); });
  return is_read([&] {
    const nn::CocoAnnotations read = nn::read_coco_annotations(file.path());
    for (const nn::CocoImage& image : read.images)
      require(image.width >= 0 && image.height >= 0, "images have pixels, or their sizes are not told");
    for (const nn::CocoAnnotation& annotation : read.annotations) {
      require(annotation.image < read.images.size(), "every annotation has an image");
      require(annotation.category < read.categories.size(), "every annotation has a category");
      require(std::isfinite(annotation.area), "areas are finite");
      const nn::CocoImage& image = read.images[annotation.image];
      require(annotation.segmentation.is_missing() || (image.width > 0 && image.height > 0),
              "images of masks have pixels");
    }
  });
}

bool read_coco_results(std::string_view bytes) {
  static const nn::CocoAnnotations data_set = [] {
    const MemoryFile file(R"({"images": [{"id": 1, "width": 8, "height": 6}],
        "categories": [{"id": 1, "name": "car"}, {"id": 3, "name": "bus"}], "annotations": []})");
    return nn::read_coco_annotations(file.path());
  }();
  const MemoryFile file(bytes);
  return is_read([&] {
    for (const nn::CocoResult& result : nn::read_coco_results(file.path(), data_set).results) {
      require(result.image == 0 && result.category < 2, "every result is of the data set");
      require(std::isfinite(result.score) && std::isfinite(result.area), "scores and areas are finite");
    }
  });
}

}  // namespace penumbra::fuzz
