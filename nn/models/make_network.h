// The network that a checkpoint belongs to.
#pragma once

#include <memory>

#include "nn/models/instance_segmenter.h"
#include "nn/models/mask_rcnn.h"
#include "nn/models/yolov5.h"

namespace penumbra::nn {

// Settings of every kind; the one that the weights belong to is used.
struct NetworkConfig {
  MaskRcnnConfig mask_rcnn;
  Yolov5Config yolov5;
};

// Tells the kind by the weights' metadata "network" ("mask_rcnn", "yolov5" or "afnet"), else by their names:
// YOLOv5's begin with "model.", all others are taken for Mask R-CNN's. Throws InputError as the networks do,
// or where the metadata names another kind.
std::unique_ptr<InstanceSegmenter> make_network(const StateDict& weights, const NetworkConfig& config = {});

}  // namespace penumbra::nn
