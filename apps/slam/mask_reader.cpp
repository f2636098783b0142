#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <memory>

#include "apps/common/made_truth.h"
#include "apps/slam/segmenter.h"
#include "nn/base/error.h"
#include "nn/image/image_file.h"
#include "nn/image/shapes.h"
#include "slam/sources/folder_listing.h"

namespace penumbra::apps {

namespace {

constexpr int kFewestMaskPixels = 20;

using Instances = std::map<int, MadeInstance>;
using MaskFiles = std::map<int, std::filesystem::path>;  // by the numbers of their frames

// From beside the folder or in it.
Instances read_instances(const std::filesystem::path& folder) {
  const std::filesystem::path inside = folder / "instances.json";
  if (std::filesystem::exists(inside)) return read_instance_list(inside);
  return read_instance_list(folder.lexically_normal().parent_path() / "instances.json");
}

std::vector<slam::Instance> instances_of(const WordImage& numbers, const Instances& known) {
  std::map<int, Rect> regions;
  for (int y = 0; y < numbers.height(); ++y) {
    for (int x = 0; x < numbers.width(); ++x) {
      if (numbers.at(x, y) == 0) continue;
      Rect& region = regions[numbers.at(x, y)];
      region = bounding(region, {x, y, 1, 1});
    }
  }
  std::vector<slam::Instance> instances;
  for (const auto& [number, region] : regions) {
    const auto at = known.find(number);
    slam::Instance instance;
    instance.class_name = at == known.end() ? "unknown" : at->second.class_name;
    instance.score = 1.0F;
    instance.region = region;
    instance.mask.create(region.width, region.height);
    int pixels = 0;
    for (int y = 0; y < region.height; ++y) {
      for (int x = 0; x < region.width; ++x) {
        const bool inside = numbers.at(region.x + x, region.y + y) == number;
        instance.mask.at(x, y) = inside ? 255 : 0;
        pixels += inside;
      }
    }
    if (pixels >= kFewestMaskPixels) instances.push_back(std::move(instance));
  }
  return instances;
}

// The masks, by the numbers of their frames: NNNNNN.png, or, where none is named so, the images in the order
// of their names.
MaskFiles list_masks(const std::filesystem::path& folder) {
  std::error_code none;
  if (!std::filesystem::is_directory(folder, none)) {
    throw InputError(folder.string(),
                     "a folder of masks: NNNNNN.png for frame NNNNNN, or one for each frame by their order",
                     std::filesystem::exists(folder, none) ? "a file" : "no such folder");
  }
  constexpr std::size_t kDigits = 6;
  std::vector<std::filesystem::path> images;
  MaskFiles numbered;
  for (const std::filesystem::path& path : slam::list_folder(folder)) {
    if (nn::image_ending(path) != ".png") continue;
    images.push_back(path);
    const std::string stem = path.stem().string();
    if (stem.size() == kDigits && stem.find_first_not_of("0123456789") == stem.npos)
      numbered[std::stoi(stem)] = path;
  }
  if (images.empty()) throw InputError(folder.string(), "masks as PNG images", "none");
  if (!numbered.empty()) return numbered;
  for (const std::filesystem::path& path : images) numbered.emplace(static_cast<int>(numbered.size()), path);
  return numbered;
}

// Takes `margin` pixels off the outlines of what is not 0.
void take_off(int margin, ByteImage& mask) {
  const ByteImage wide = mask.clone();
  const auto is_inside = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < wide.width() && y < wide.height() && wide.at(x, y) != 0;
  };
  for (int y = 0; y < wide.height(); ++y) {
    for (int x = 0; x < wide.width(); ++x) {
      if (wide.at(x, y) == 0 &&
          (is_inside(x - 1, y) || is_inside(x + 1, y) || is_inside(x, y - 1) || is_inside(x, y + 1)))
        fill_disc(mask, {x, y}, margin, 0);
    }
  }
}

// `mask`: 0 on people, and by `margin` pixels too wide. What hangs together is a person.
std::vector<slam::Instance> people_of(ByteImage mask, int margin) {
  std::transform(mask.data(), mask.data() + mask.elements(), mask.data(),
                 [](std::uint8_t value) { return static_cast<std::uint8_t>(value == 0 ? 255 : 0); });
  take_off(margin, mask);
  Image<std::int32_t> labels;
  Instances people;
  for (int n = connected_components(mask, labels); n > 0; --n) people[n].class_name = "person";
  WordImage numbers(mask.width(), mask.height());
  std::transform(labels.data(), labels.data() + labels.elements(), numbers.data(),
                 [](std::int32_t label) { return static_cast<std::uint16_t>(label); });
  return instances_of(numbers, people);
}

// Throws InputError for a mask at `path` of another size than the frame's image.
void require_size(const std::filesystem::path& path, const Size& size, const Size& expected) {
  if (size == expected) return;
  throw InputError(path.string(), fmt::format("{}x{} pixels", expected.width, expected.height),
                   fmt::format("{}x{}", size.width, size.height));
}

}  // namespace

slam::Segmenter make_people_mask_reader(const std::filesystem::path& folder, int margin) {
  const auto masks = std::make_shared<const MaskFiles>(list_masks(folder));
  return [masks, margin](const slam::ImageToSegment& from) -> std::vector<slam::Instance> {
    const auto known = masks->find(from.frame);
    if (known == masks->end()) return {};
    ByteImage mask = nn::read_image(known->second, nn::ImageColour::grey);
    require_size(known->second, mask.size(), from.image.size());
    return people_of(std::move(mask), margin);
  };
}

slam::Segmenter make_mask_reader(const std::filesystem::path& folder) {
  const auto masks = std::make_shared<const MaskFiles>(list_masks(folder));
  const auto names = std::make_shared<const Instances>(read_instances(folder));
  return [masks, names](const slam::ImageToSegment& from) -> std::vector<slam::Instance> {
    const ByteImage& image = from.image;
    const auto known = masks->find(from.frame);
    if (known == masks->end()) return {};
    const std::filesystem::path& path = known->second;
    const WordImage numbers = nn::read_depth_image(path, "a 16-bit grey PNG of instance numbers");
    require_size(path, numbers.size(), image.size());
    return instances_of(numbers, *names);
  };
}

slam::Segmenter make_segmenter(const std::filesystem::path& masks, const slam::StereoCamera& camera,
                               const slam::SemanticsSettings& settings) {
  return refine_masks(make_mask_reader(masks), camera, settings);
}

}  // namespace penumbra::apps
