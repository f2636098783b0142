#include <fmt/core.h>

#include <map>
#include <memory>

#include "apps/common/made_truth.h"
#include "apps/slam/segmenter.h"
#include "nn/base/error.h"
#include "nn/image/image_file.h"
#include "slam/sources/folder_listing.h"

namespace penumbra::apps {

namespace {

constexpr int kFewestMaskPixels = 20;

using Instances = std::map<int, MadeInstance>;

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
std::map<int, std::filesystem::path> list_masks(const std::filesystem::path& folder) {
  constexpr std::size_t kDigits = 6;
  std::vector<std::filesystem::path> images;
  std::map<int, std::filesystem::path> numbered;
  for (const std::filesystem::path& path : slam::list_folder(folder)) {
    if (nn::image_ending(path) != ".png") continue;
    images.push_back(path);
    const std::string stem = path.stem().string();
    if (stem.size() == kDigits && stem.find_first_not_of("0123456789") == stem.npos)
      numbered[std::stoi(stem)] = path;
  }
  if (!numbered.empty()) return numbered;
  for (const std::filesystem::path& path : images) numbered.emplace(static_cast<int>(numbered.size()), path);
  return numbered;
}

}  // namespace

slam::Segmenter make_mask_reader(const std::filesystem::path& folder) {
  const auto names = std::make_shared<const Instances>(read_instances(folder));
  const auto masks = std::make_shared<const std::map<int, std::filesystem::path>>(list_masks(folder));
  return [masks, names](const slam::ImageToSegment& from) -> std::vector<slam::Instance> {
    const ByteImage& image = from.image;
    const auto known = masks->find(from.frame);
    if (known == masks->end()) return {};
    const std::filesystem::path& path = known->second;
    const WordImage numbers = nn::read_depth_image(path, "a 16-bit grey PNG of instance numbers");
    if (numbers.size() != image.size()) {
      throw InputError(path.string(), fmt::format("{}x{} pixels", image.width(), image.height()),
                       fmt::format("{}x{}", numbers.width(), numbers.height()));
    }
    return instances_of(numbers, *names);
  };
}

}  // namespace penumbra::apps
