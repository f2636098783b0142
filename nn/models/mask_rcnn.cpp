#include "nn/models/mask_rcnn.h"

#include <array>
#include <cmath>

#include "nn/base/error.h"

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

float batch_norm_eps(const StateDict& weights, float otherwise) {
  const auto found = weights.metadata.find("batch_norm_eps");
  if (found == weights.metadata.end()) return otherwise;
  char* end = nullptr;
  const float eps = std::strtof(found->second.c_str(), &end);
  if (end == found->second.c_str() || *end != '\0' || !(eps >= 0.0F && eps < 1.0F)) {
    throw InputError(weights.source + ", metadata batch_norm_eps", "a number in [0, 1)", found->second);
  }
  return eps;
}

// Map pixels per image pixel, a power of two as torchvision infers it.
float level_scale(const FeatureMap& map, const ImageExtent& image) {
  return std::exp2(
      std::round(std::log2(static_cast<float>(map.height()) / static_cast<float>(image.height))));
}

}  // namespace

MaskRcnn::MaskRcnn(const StateDict& state_dict, MaskRcnnConfig config) : config_(config) {
  config_.batch_norm_eps = batch_norm_eps(state_dict, config.batch_norm_eps);
  const StateDict renamed = with_current_names(state_dict);
  WeightReader weights(renamed);
  backbone_ = ResNet(weights, kBody, resnet_shape(weights, kBody), config_.batch_norm_eps);
  pyramid_ = FeaturePyramid(weights, "backbone.fpn.", backbone_.channels(), config_.attention);
  rpn_ = RegionProposalNetwork(weights, "rpn.head.", config_.rpn);
  box_head_ = BoxHead(weights, "roi_heads.", config_.box_head);
  mask_head_ = MaskHead(weights, "roi_heads.", box_head_.classes(), config_.mask_head);
  weights.finish(name());
}

std::string MaskRcnn::name() const {
  return fmt::format("Mask R-CNN ResNet-{} FPN{}", backbone_.shape().depth,
                     has_attention() ? " with mixed attention" : "");
}

void MaskRcnn::detect(const cv::Mat& image, Arena& arena, std::vector<Detection>& detections) const {
  const ImageExtent extent = transformed_extent(image, config_.transform);
  const Arena::Pass pass(arena, this, extent.padded_height, extent.padded_width);
  FeatureMap input = transform_image(image, config_.transform, arena, ResNet::kImageBorder);
  const std::array<FeatureMap, kPyramidLevels> pyramid = pyramid_(backbone_(std::move(input), arena), arena);
  const ArenaVector<Box> proposals = rpn_(pyramid, extent, arena);

  std::array<PyramidLevel, 4> levels;  // the heads read P2..P5
  for (std::size_t k = 0; k < levels.size(); ++k) levels[k] = {&pyramid[k], level_scale(pyramid[k], extent)};
  const ArenaVector<ScoredBox> boxes = box_head_(levels, proposals, extent, arena);
  const ArenaVector<float> probabilities = mask_head_(levels, boxes, arena);

  const float ratio_x = static_cast<float>(image.cols) / static_cast<float>(extent.width);
  const float ratio_y = static_cast<float>(image.rows) / static_cast<float>(extent.height);
  const int size = mask_head_.mask_size();
  detections.resize(boxes.size());
#pragma omp parallel for schedule(dynamic)
  for (std::size_t d = 0; d < boxes.size(); ++d) {
    const Box& box = boxes[d].box;
    Detection& detection = detections[d];
    detection.box = {box.x1 * ratio_x, box.y1 * ratio_y, box.x2 * ratio_x, box.y2 * ratio_y};
    detection.score = boxes[d].score;
    detection.label = boxes[d].label;
    const auto pixels = static_cast<std::size_t>(size * size);
    paste_mask(probabilities.span().subspan(d * pixels, pixels), size, detection.box, image.cols, image.rows,
               config_.mask_threshold, detection.mask);
  }
}

}  // namespace penumbra::nn
