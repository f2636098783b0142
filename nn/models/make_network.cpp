#include "nn/models/make_network.h"

#include <string>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/models/interest_network.h"

namespace penumbra::nn {

namespace {

constexpr const char* kMaskRcnn = "mask_rcnn";
constexpr const char* kYolov5 = "yolov5";
constexpr const char* kInterest = "interest";  // finds landmarks, not objects
constexpr const char* kAfnet = "afnet";        // a YOLOv5 whose weights have attention or ASFF

std::string kind_of(const StateDict& weights) {
  const auto named = weights.metadata.find("network");
  if (named != weights.metadata.end()) return named->second;
  if (is_interest_network(weights)) return kInterest;
  const auto first = weights.tensors.lower_bound("model.");
  return first != weights.tensors.end() && first->first.starts_with("model.") ? kYolov5 : kMaskRcnn;
}

}  // namespace

std::unique_ptr<InstanceSegmenter> make_network(const StateDict& weights, const NetworkConfig& config) {
  const std::string kind = kind_of(weights);
  if (kind == kMaskRcnn) return std::make_unique<MaskRcnn>(weights, config.mask_rcnn);
  if (kind == kYolov5 || kind == kAfnet) return std::make_unique<Yolov5>(weights, config.yolov5);
  throw InputError(weights.source + ", metadata network",
                   fmt::format("'{}', '{}' or '{}'", kMaskRcnn, kYolov5, kAfnet),
                   fmt::format("'{}'", printable(kind)));
}

}  // namespace penumbra::nn
