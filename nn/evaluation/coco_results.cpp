#include "nn/evaluation/coco_results.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "nn/base/error.h"
#include "nn/io/coco_rle.h"
#include "nn/io/file.h"

namespace penumbra::nn {

namespace {

// The text as JSON, in quotes; bytes that are not UTF-8 become the replacement character.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

CocoResult read_result(const JsonFields& fields, const CocoAnnotations& annotations) {
  CocoResult result;
  const CocoImageId image_id = read_image_id(fields, "image_id");
  const auto image = annotations.image_of_id.find(image_id);
  if (image == annotations.image_of_id.end()) {
    fields.fail("image_id", "the id of an image in " + annotations.file, to_string(image_id));
  }
  result.image = image->second;
  const std::int64_t category_id = fields.integer("category_id");
  const auto category = annotations.category_of_id.find(category_id);
  if (category == annotations.category_of_id.end()) {
    fields.fail("category_id", "the id of a category in " + annotations.file, fmt::format("{}", category_id));
  }
  result.category = category->second;
  result.score = fields.number("score");

  const CocoImage& size = annotations.images[result.image];
  result.segmentation = read_segmentation(fields);
  check_mask_size(fields, result.segmentation, size);
  if (fields.has("bbox")) {
    result.box = read_coco_box(fields, "bbox");
    result.area = result.box.area();
  } else if (!result.segmentation.is_missing()) {
    const RunMask mask = to_mask(result.segmentation, size.width, size.height);
    result.box = bounding_box(mask);
    result.area = static_cast<double>(area(mask));
  } else {
    fields.fail("bbox", "a box or a segmentation", "neither");
  }
  return result;
}

}  // namespace

CocoResults read_coco_results(const std::filesystem::path& path, const CocoAnnotations& annotations) {
  CocoResults all;
  all.file = path.string();
  for_each_json_entry(path, {}, [&](const JsonEntry& entry) {
    all.results.push_back(read_result(JsonFields(entry), annotations));
  });
  return all;
}

void CocoResultsWriter::add(const CocoImageId& image, std::int64_t category_id, const Detection& detection,
                            int image_width, int image_height) {
  const auto* number = std::get_if<std::int64_t>(&image);
  const Box& box = detection.box;
  fmt::format_to(std::back_inserter(entries_),
                 "{}\n{{\"image_id\": {}, \"category_id\": {}, \"bbox\": [{}, {}, {}, {}], \"score\": {}, "
                 "\"segmentation\": {{\"size\": [{}, {}], \"counts\": {}}}}}",
                 size_ == 0 ? "" : ",",
                 number != nullptr ? fmt::format("{}", *number) : quoted(std::get<std::string>(image)),
                 category_id, box.x1, box.y1, box.width(), box.height(), detection.score, image_height,
                 image_width, quoted(encode_runs(mask_runs(detection.mask, image_width, image_height))));
  ++size_;
}

void CocoResultsWriter::write(const std::filesystem::path& path) const {
  write_file(path, "[" + entries_ + "\n]\n");
}

}  // namespace penumbra::nn
