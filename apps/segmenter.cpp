#include "apps/segmenter.h"

#include <memory>

#include "nn/base/error.h"
#include "nn/models/class_names.h"
#include "nn/models/make_network.h"
#include "weights_tools/load_weights.h"

namespace penumbra::apps {

namespace {

slam::Instance to_instance(const nn::Detection& detection, const std::vector<std::string>& names) {
  slam::Instance instance;
  instance.class_id = detection.label;
  instance.class_name = names[static_cast<std::size_t>(detection.label)];
  instance.score = detection.score;
  const nn::Mask& mask = detection.mask;
  instance.region = {mask.x, mask.y, mask.width, mask.height};
  instance.mask.create(mask.height, mask.width);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x)
      instance.mask(y, x) = mask.contains(mask.x + x, mask.y + y) ? 255 : 0;
  }
  return instance;
}

}  // namespace

slam::Segmenter load_segmenter(const std::filesystem::path& path, const std::filesystem::path& classes) {
  const nn::StateDict weights = weights_tools::load_weights(path);
  nn::NetworkConfig config;
  config.yolov5.score_threshold = config.mask_rcnn.box_head.score_threshold;
  const std::shared_ptr<nn::InstanceSegmenter> network = nn::make_network(weights, config);
  if (!network->has_masks()) {
    throw InputError(path.string(), "weights of a network that finds masks",
                     network->name() + ", boxes only");
  }
  return [network, names = nn::class_names(weights, network->classes(), classes)](const cv::Mat& image) {
    std::vector<slam::Instance> instances;
    for (const nn::Detection& detection : (*network)(image)) {
      if (!detection.mask.bits.empty()) instances.push_back(to_instance(detection, names));
    }
    return instances;
  };
}

}  // namespace penumbra::apps
