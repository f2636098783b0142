#include "apps/slam/segmenter.h"

#include <cmath>

#include "nn/base/error.h"
#include "slam/dynamics/rgbd/dbscan_masks.h"

namespace penumbra::apps {

namespace {

slam::Instance to_box(const nn::Detection& detection, const std::vector<std::string>& names) {
  slam::Instance instance;
  instance.class_id = detection.label;
  instance.class_name = names[static_cast<std::size_t>(detection.label)];
  instance.score = detection.score;
  const auto left = static_cast<int>(std::floor(detection.box.x1));
  const auto top = static_cast<int>(std::floor(detection.box.y1));
  instance.region = {left, top, static_cast<int>(std::ceil(detection.box.x2)) - left,
                     static_cast<int>(std::ceil(detection.box.y2)) - top};
  return instance;
}

slam::Instance to_instance(const nn::Detection& detection, const std::vector<std::string>& names) {
  slam::Instance instance = to_box(detection, names);
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

slam::Segmenter refine_masks(slam::Segmenter segmenter, const slam::StereoCamera& camera,
                             const slam::SemanticsSettings& settings) {
  switch (settings.depth_masks.masks) {
    case slam::InstanceMasks::depth_clusters:
      return slam::masks_from_depth(std::move(segmenter), camera, settings.instances.least_score,
                                    settings.depth_masks);
    case slam::InstanceMasks::dbscan:
      return slam::masks_by_dbscan(std::move(segmenter), settings.instances.least_score,
                                   settings.depth_masks.foreground);
    case slam::InstanceMasks::boxes:
      return slam::masks_of_boxes(std::move(segmenter));
    case slam::InstanceMasks::detector:
      break;
  }
  return segmenter;
}

nn::NetworkConfig slam_network_config() {
  nn::NetworkConfig config;
  config.yolov5.score_threshold = config.mask_rcnn.box_head.score_threshold;
  return config;
}

double least_score_of(const LoadedNetwork& loaded) {
  constexpr double kOfBoxes = 0.3;
  return loaded.network->has_masks() ? slam::InstanceTrackerSettings{}.least_score : kOfBoxes;
}

slam::Segmenter make_segmenter(const LoadedNetwork& loaded, const slam::StereoCamera& camera,
                               const slam::SemanticsSettings& settings) {
  const bool boxes = settings.depth_masks.masks != slam::InstanceMasks::detector;
  if (!boxes && !loaded.network->has_masks()) {
    throw InputError(loaded.source,
                     "weights of a network that finds masks, or, with an RGB-D recording, --dynamics "
                     "depth-clusters, which makes masks of boxes",
                     loaded.network->name() + ", boxes only");
  }
  return refine_masks(
      [loaded, boxes](const slam::ImageToSegment& from) {
        std::vector<slam::Instance> instances;
        for (const nn::Detection& detection : (*loaded.network)(from.image)) {
          if (boxes) {
            instances.push_back(to_box(detection, loaded.names));
          } else if (!detection.mask.bits.empty()) {
            instances.push_back(to_instance(detection, loaded.names));
          }
        }
        return instances;
      },
      camera, settings);
}

}  // namespace penumbra::apps
