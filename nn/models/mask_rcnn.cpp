#include "nn/models/mask_rcnn.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "nn/base/parallel.h"
#include "nn/models/weight_metadata.h"

namespace penumbra::nn {

namespace {

constexpr const char* kBody = "backbone.body.";

// Weights saved before torchvision 0.13 name some layers without their index in a sequence.
std::string current_name(const std::string& name) {
  const auto insert_index = [&](const std::string& prefix) {
    // "prefix3.weight" -> "prefix3.0.weight"
    const std::size_t dot = name.find('.', prefix.size());
    return dot != std::string::npos && name.find('.', dot + 1) == std::string::npos
               ? name.substr(0, dot) + ".0" + name.substr(dot)
               : name;
  };
  for (const std::string prefix : {"backbone.fpn.inner_blocks.", "backbone.fpn.layer_blocks."}) {
    if (name.starts_with(prefix)) return insert_index(prefix);
  }
  if (name == "rpn.head.conv.weight") return "rpn.head.conv.0.0.weight";
  if (name == "rpn.head.conv.bias") return "rpn.head.conv.0.0.bias";
  const std::string mask_layer = "roi_heads.mask_head.mask_fcn";
  if (name.starts_with(mask_layer) && name.size() > mask_layer.size() + 1) {
    const int index = name[mask_layer.size()] - '1';
    return fmt::format("roi_heads.mask_head.{}.0{}", index, name.substr(mask_layer.size() + 1));
  }
  return name;
}

StateDict with_current_names(const StateDict& weights) {
  StateDict renamed = weights;
  renamed.tensors.clear();
  for (const auto& [name, tensor] : weights.tensors) renamed.tensors.emplace(current_name(name), tensor);
  return renamed;
}

// The config with what the weights say of themselves, and then with what the user asks for.
MaskRcnnConfig with_metadata(const StateDict& weights, MaskRcnnConfig config) {
  const auto set = [&](const char* key, int& value, int least, int most) {
    value = metadata_integer(weights, key, {static_cast<double>(least), static_cast<double>(most)})
                .value_or(value);
  };
  config.batch_norm_eps = static_cast<float>(
      metadata_number(weights, "batch_norm_eps", {0.0, 1.0}).value_or(config.batch_norm_eps));
  set("box_head_layers", config.box_head.layers, 1, 2);
  set("mask_head_layers", config.mask_head.layers, 1, MaskHeadConfig::kMostLayers);
  set("min_size", config.transform.min_size, 32, 4096);
  set("max_size", config.transform.max_size, 32, 8192);
  set("rpn_candidates", config.rpn.candidates_per_level, 1, 10000);
  set("rpn_proposals", config.rpn.proposals, 1, 10000);
  const std::vector<double> sizes =
      metadata_numbers(weights, "anchor_sizes", config.rpn.anchor_sizes.size(), {1.0, 4096.0});
  std::transform(sizes.begin(), sizes.end(), config.rpn.anchor_sizes.begin(),
                 [](double size) { return static_cast<float>(size); });
  config.transform.min_size = config.min_size.value_or(config.transform.min_size);
  config.transform.max_size = config.max_size.value_or(config.transform.max_size);
  config.rpn.proposals = config.proposals.value_or(config.rpn.proposals);
  return config;
}

// Map pixels per image pixel, a power of two as torchvision infers it.
float level_scale(const FeatureMap& map, const ImageExtent& image) {
  return std::exp2(
      std::round(std::log2(static_cast<float>(map.height()) / static_cast<float>(image.height))));
}

}  // namespace

MaskRcnn::MaskRcnn(const StateDict& state_dict, MaskRcnnConfig config)
    : config_(with_metadata(state_dict, config)) {
  const StateDict renamed = with_current_names(state_dict);
  WeightReader weights(renamed, config_.precision);
  config_.precision = weights.precision();
  weights.expect_metadata("activations", "ReLU");
  weights.expect_metadata("image_mean", "0.485,0.456,0.406");
  weights.expect_metadata("image_std", "0.229,0.224,0.225");
  weights.expect_metadata("aspect_ratios", "0.5,1,2,0.5,1,2,0.5,1,2,0.5,1,2,0.5,1,2");
  backbone_ = ResNet(weights, kBody, resnet_shape(weights, kBody), config_.batch_norm_eps);
  pyramid_ = FeaturePyramid(weights, "backbone.fpn.", backbone_.channels(), config_.attention);
  const int channels = pyramid_.channels();
  rpn_ = RegionProposalNetwork(weights, "rpn.head.", channels, config_.rpn);
  box_head_ = BoxHead(weights, "roi_heads.", channels, config_.box_head);
  mask_head_ = MaskHead(weights, "roi_heads.", channels, box_head_.classes(), config_.mask_head);
  weights.finish(name());
}

std::string MaskRcnn::name() const {
  return fmt::format("Mask R-CNN ResNet-{} FPN{}", backbone_.shape().depth,
                     has_attention() ? " with mixed attention" : "");
}

void MaskRcnn::detect(const ByteView& image, Arena& arena, std::vector<Detection>& detections) const {
  const ImageExtent extent = transformed_extent(image, config_.transform);
  const Arena::Pass pass(arena, this, extent.padded_height, extent.padded_width);
  FeatureMap input = transform_image(image, config_.transform, arena, ResNet::kImageBorder);
  const std::array<FeatureMap, kPyramidLevels> pyramid = this->pyramid(std::move(input), arena);
  const ArenaVector<Box> proposals = rpn_(pyramid, extent, arena);

  std::array<PyramidLevel, 4> levels;  // the heads read P2..P5
  for (std::size_t k = 0; k < levels.size(); ++k) levels[k] = {&pyramid[k], level_scale(pyramid[k], extent)};
  const ArenaVector<ScoredBox> boxes = box_head_(levels, proposals, extent, arena);
  const ArenaVector<float> probabilities = mask_head_(levels, boxes, arena);

  const float ratio_x = static_cast<float>(image.width) / static_cast<float>(extent.width);
  const float ratio_y = static_cast<float>(image.height) / static_cast<float>(extent.height);
  const int size = mask_head_.mask_size();
  detections.resize(boxes.size());
  parallel_for(boxes.size(), 1, [&](std::size_t d) {
    const Box& box = boxes[d].box;
    Detection& detection = detections[d];
    detection.box = {box.x1 * ratio_x, box.y1 * ratio_y, box.x2 * ratio_x, box.y2 * ratio_y};
    detection.score = boxes[d].score;
    detection.label = boxes[d].label;
    const auto pixels = static_cast<std::size_t>(size * size);
    paste_mask(probabilities.span().subspan(d * pixels, pixels), size, detection.box, image.width,
               image.height, config_.mask_threshold, detection.mask);
  });
}

}  // namespace penumbra::nn
