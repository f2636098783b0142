#include "nn/evaluation/coco_results.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/evaluation/coco_rle.h"

namespace penumbra::nn {

namespace {

// The text as JSON, in quotes; bytes that are not UTF-8 become the replacement character.
std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void read_result(const JsonFields& fields, const CocoAnnotations& annotations, CocoRules rules,
                 CocoResults& all) {
  CocoResult result;
  const CocoImageId image_id = read_image_id(fields, "image_id");
  const auto image = annotations.image_of_id.find(image_id);
  if (image == annotations.image_of_id.end()) {
    fields.fail("image_id", "the id of an image in " + annotations.file, to_string(image_id));
  }
  result.image = image->second;
  result.score = fields.number("score");

  const CocoImage& size = annotations.images[result.image];
  std::optional<InputError> problem;
  result.segmentation = read_coco_mask(fields, size, problem);
  const bool has_box = has_coco_box(fields, "bbox"), has_mask = !problem;
  if (all.results.empty() && all.of_unknown_categories == 0) all.first_has_box = has_box;
  if (has_box) result.box = read_coco_box(fields, "bbox");
  if (!has_box && !fields.has("segmentation")) fields.fail("bbox", "a box or a segmentation", "neither");
  // Without a box the mask is all that there is.
  if (!has_box && problem) throw *problem;
  const bool box_gives_area = has_box && (rules == CocoRules::sensible || all.first_has_box || !has_mask);
  if (!has_box || !box_gives_area) {
    const RunMask mask = to_mask(result.segmentation, size.width, size.height);
    if (!has_box) result.box = bounding_box(mask);
    result.area = static_cast<double>(area(mask));
  }
  if (box_gives_area) result.area = result.box.area();

  const auto category = annotations.category_of_id.find(fields.integer("category_id"));
  if (category == annotations.category_of_id.end()) {
    ++all.of_unknown_categories;
    return;
  }
  result.category = category->second;
  if (has_box) ++all.with_boxes;
  if (problem && !all.problems.masks) all.problems.masks = std::move(problem);
  all.results.push_back(std::move(result));
}

}  // namespace

CocoResults read_coco_results(const std::filesystem::path& path, const CocoAnnotations& annotations,
                              CocoRules rules) {
  CocoResults all;
  all.file = path.string();
  for_each_json_entry(
      path, {}, [&](const JsonEntry& entry) { read_result(JsonFields(entry), annotations, rules, all); });
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
