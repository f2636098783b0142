#include "nn/evaluation/coco_annotations.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::nn {

namespace {

using nlohmann::json;

// 0 where the file gives no side that an image can have: only masks need it, and say so then.
int read_image_side(const JsonFields& fields, const char* key) {
  if (!fields.has(key)) return 0;
  const std::optional<std::int64_t> side = whole_number(fields.at(key));
  return side && *side >= 1 && *side <= kLargestImageSide ? static_cast<int>(*side) : 0;
}

// Absent, false, true or a number, of which all but 0 are true.
bool read_flag(const JsonFields& fields, const char* key) {
  if (!fields.has(key)) return false;
  const json& value = fields.at(key);
  return value.is_boolean() ? value.get<bool>() : fields.number(key) != 0.0;
}

// Names that a program has written as numbers are names all the same.
std::string read_name(const JsonFields& fields, const char* key) {
  if (!fields.has(key)) return {};
  return fields.at(key).is_number() ? fields.at(key).dump() : fields.text(key);
}

CocoImage read_image(const JsonFields& fields) {
  CocoImage image;
  image.id = read_image_id(fields, "id");
  image.width = read_image_side(fields, "width");
  image.height = read_image_side(fields, "height");
  image.file_name = read_name(fields, "file_name");
  return image;
}

void read_annotation(const JsonFields& fields, CocoAnnotations& all) {
  CocoAnnotation annotation;
  annotation.has_id_0 = fields.integer("id") == 0;
  const auto image = all.image_of_id.find(read_image_id(fields, "image_id"));
  const auto category = all.category_of_id.find(fields.integer("category_id"));
  if (image == all.image_of_id.end()) {
    ++all.of_unknown_images;
    return;
  }
  if (category == all.category_of_id.end()) {
    ++all.of_unknown_categories;
    return;
  }
  annotation.image = image->second;
  annotation.category = category->second;
  if (has_coco_box(fields, "bbox")) {
    annotation.box = read_coco_box(fields, "bbox");
  } else if (!all.problems.boxes) {
    all.problems.boxes = InputError(fields.place("bbox"), "a box, as boxes are to be evaluated", "none");
  }
  annotation.area = fields.number("area");
  if (annotation.area < 0.0) fields.fail("area", "a number >= 0", fmt::format("{}", annotation.area));
  annotation.is_crowd = read_flag(fields, "iscrowd");
  annotation.segmentation = read_coco_mask(fields, all.images[annotation.image], all.problems.masks);
  if (fields.has("occlusion")) {
    annotation.occlusion = fields.number("occlusion");
    if (*annotation.occlusion < 0.0 || *annotation.occlusion > 1.0) {
      fields.fail("occlusion", "a number in 0..1", fmt::format("{}", *annotation.occlusion));
    }
  }
  all.annotations.push_back(std::move(annotation));
}

}  // namespace

std::string to_string(const CocoImageId& id) {
  if (const auto* number = std::get_if<std::int64_t>(&id)) return fmt::format("{}", *number);
  return fmt::format("\"{}\"", printable(std::get<std::string>(id)));
}

CocoImageId read_image_id(const JsonFields& fields, const char* key) {
  const json& value = fields.at(key);
  if (value.is_string()) return value.get<std::string>();
  if (!whole_number(value)) fields.fail(key, "a whole number or a text", describe(value));
  return fields.integer(key);
}

CocoBox read_coco_box(const JsonFields& fields, const char* key) {
  const json& list = fields.at(key);
  if (!list.is_array() || list.size() != 4) fields.fail(key, "[x, y, width, height]", describe(list));
  for (const json& number : list) {
    if (!number.is_number()) fields.fail(key, "four numbers", describe(number));
    if (std::abs(number.get<double>()) > kLargestCoordinate) {
      fields.fail(key, fmt::format("numbers within +-{:g} pixels", kLargestCoordinate), describe(number));
    }
  }
  const CocoBox box{list[0].get<double>(), list[1].get<double>(), list[2].get<double>(),
                    list[3].get<double>()};
  if (box.width < 0.0 || box.height < 0.0) {
    fields.fail(key, "width and height >= 0", fmt::format("{} x {}", box.width, box.height));
  }
  return box;
}

bool has_coco_box(const JsonFields& fields, const char* key) {
  return fields.has(key) && !(fields.at(key).is_array() && fields.at(key).empty());
}

CocoSegmentation read_coco_mask(const JsonFields& fields, const CocoImage& image,
                                std::optional<InputError>& problem) {
  constexpr const char* kKey = "segmentation";
  try {
    CocoSegmentation segmentation = read_segmentation(fields);
    if (segmentation.is_missing()) {
      throw InputError(fields.place(), "a segmentation, as masks are to be evaluated", "none");
    }
    // A mask of run lengths carries its size.
    if ((image.width == 0 || image.height == 0) && segmentation.mask.width == 0) {
      fields.fail(
          kKey,
          fmt::format("width and height of image {}, as masks are to be evaluated", to_string(image.id)),
          "none");
    }
    const RunMask& mask = segmentation.mask;
    const bool has_size = image.width != 0 && image.height != 0;
    if (has_size && mask.width != 0 && (mask.width != image.width || mask.height != image.height)) {
      fields.fail("segmentation, size",
                  fmt::format("that of image {}, [{}, {}]", to_string(image.id), image.height, image.width),
                  fmt::format("[{}, {}]", mask.height, mask.width));
    }
    return segmentation;
  } catch (const InputError& error) {
    if (!problem) problem = error;
    return {};
  }
}

CocoAnnotations read_coco_images(const std::filesystem::path& path) {
  CocoAnnotations all;
  all.file = path.string();
  for_each_json_entry(path, {"images", "categories"}, [&](const JsonEntry& entry) {
    const JsonFields fields(entry);
    if (entry.section == "images") {
      all.images.push_back(read_image(fields));
      const CocoImageId& id = all.images.back().id;
      if (!all.image_of_id.emplace(id, all.images.size() - 1).second) {
        fields.fail("id", "an id of its own", to_string(id) + " a second time");
      }
    } else {
      const std::int64_t id = fields.integer("id");
      all.categories.push_back({id, read_name(fields, "name")});
      if (!all.category_of_id.emplace(id, all.categories.size() - 1).second) {
        fields.fail("id", "an id of its own", fmt::format("{} a second time", id));
      }
    }
  });
  return all;
}

CocoAnnotations read_coco_annotations(const std::filesystem::path& path) {
  // Two passes, because annotations may stand before the images that they refer to.
  CocoAnnotations all = read_coco_images(path);
  std::unordered_set<std::int64_t> ids;
  for_each_json_entry(path, {"annotations"}, [&](const JsonEntry& entry) {
    const JsonFields fields(entry);
    const std::int64_t id = fields.integer("id");
    if (!ids.insert(id).second) fields.fail("id", "an id of its own", fmt::format("{} a second time", id));
    read_annotation(fields, all);
  });
  return all;
}

}  // namespace penumbra::nn
