#include "apps/slam/segmenter.h"

#include "nn/base/error.h"

namespace penumbra::apps {

namespace {

slam::Instance to_instance(const nn::Detection& detection, const std::vector<std::string>& names) {
  slam::Instance instance;
  instance.class_id = detection.label;
  instance.class_name = names[static_cast<std::size_t>(detection.label)];
  instance.score = detection.score;
  const nn::Mask& mask = detection.mask;
  instance.region = {mask.x, mask.y, mask.width, mask.height};
  instance.mask.create(mask.width, mask.height);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x)
      instance.mask.at(x, y) = mask.contains(mask.x + x, mask.y + y) ? 255 : 0;
  }
  return instance;
}

}  // namespace

nn::NetworkConfig slam_network_config() {
  nn::NetworkConfig config;
  config.yolov5.score_threshold = config.mask_rcnn.box_head.score_threshold;
  return config;
}

slam::Segmenter make_segmenter(const LoadedNetwork& loaded) {
  if (!loaded.network->has_masks()) {
    throw InputError(loaded.source, "weights of a network that finds masks",
                     loaded.network->name() + ", boxes only");
  }
  return [loaded](int /*frame*/, const ByteImage& image) {
    std::vector<slam::Instance> instances;
    for (const nn::Detection& detection : (*loaded.network)(image)) {
      if (!detection.mask.bits.empty()) instances.push_back(to_instance(detection, loaded.names));
    }
    return instances;
  };
}

}  // namespace penumbra::apps
