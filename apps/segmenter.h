// The network as the SLAM's segmenter.
#pragma once

#include "apps/load_network.h"
#include "slam/semantics/instance.h"

namespace penumbra::apps {

// Settings of a network whose masks the SLAM uses.
nn::NetworkConfig slam_network_config();

// The segmenter shares the network, Mask R-CNN or YOLOv5. Throws InputError where it finds boxes without
// masks.
slam::Segmenter make_segmenter(const LoadedNetwork& loaded);

}  // namespace penumbra::apps
