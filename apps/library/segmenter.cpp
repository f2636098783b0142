#include "penumbra/segmenter.h"

#include "apps/library/pixels.h"
#include "apps/network/loaded_network.h"
#include "weights_tools/load_weights.h"

namespace penumbra {

namespace {

Instance instance_of(const nn::Detection& found, const std::vector<std::string>& names) {
  const nn::Mask& mask = found.mask;
  Instance instance{.class_id = found.label,
                    .class_name = names[static_cast<std::size_t>(found.label)],
                    .score = found.score,
                    .x1 = found.box.x1,
                    .y1 = found.box.y1,
                    .x2 = found.box.x2,
                    .y2 = found.box.y2};
  if (mask.bits.empty()) return instance;
  instance.mask_x = mask.x;
  instance.mask_y = mask.y;
  instance.mask_width = mask.width;
  instance.mask_height = mask.height;
  instance.mask.reserve(static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
  for (int y = mask.y; y < mask.y + mask.height; ++y) {
    for (int x = mask.x; x < mask.x + mask.width; ++x) instance.mask.push_back(mask.contains(x, y));
  }
  return instance;
}

}  // namespace

struct Segmenter::Loaded {
  SegmenterOptions options;
  apps::LoadedNetwork of;
};

Segmenter::Segmenter(const std::string& weights, SegmenterOptions options)
    : loaded_(std::make_unique<Loaded>(Loaded{
          options, apps::network_of(weights_tools::load_weights(weights), weights, options.classes, {})})) {}

Segmenter::~Segmenter() = default;
Segmenter::Segmenter(Segmenter&&) noexcept = default;
Segmenter& Segmenter::operator=(Segmenter&&) noexcept = default;

std::string Segmenter::network() const { return loaded_->of.network->name(); }

bool Segmenter::has_masks() const { return loaded_->of.network->has_masks(); }

std::vector<Instance> Segmenter::find(const ImageRef& image) {
  std::vector<Instance> instances;
  for (const nn::Detection& found : (*loaded_->of.network)(byte_image_of(image, {}, "image"))) {
    if (found.score >= loaded_->options.least_score)
      instances.push_back(instance_of(found, loaded_->of.names));
  }
  return instances;
}

}  // namespace penumbra
