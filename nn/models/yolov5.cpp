#include "nn/models/yolov5.h"

#include <algorithm>
#include <array>
#include <utility>

#include "nn/base/parallel.h"
#include "nn/layers/nms.h"
#include "nn/layers/prototype_mask.h"
#include "nn/models/coco_categories.h"
#include "nn/models/weight_metadata.h"

namespace penumbra::nn {

Yolov5::Yolov5(const StateDict& state_dict, Yolov5Config config) : config_(config) {
  const std::optional<int> own = metadata_integer(state_dict, "max_size", {32.0, 8192.0});
  config_.letterbox.size = config.max_size.value_or(own.value_or(config.letterbox.size));
  WeightReader weights(state_dict, config_.precision);
  weights.expect_metadata("activations", "SiLU");
  weights.expect_metadata("stride", "8,16,32");
  shape_ = yolov5_shape(weights);
  features_ = Yolov5Features(weights, shape_);
  if (shape_.fusion) fusion_ = Yolov5Fusion(weights, shape_);
  head_ = Yolov5Head(weights, shape_);
  weights.finish(shape_.name());
}

int Yolov5::classes() const { return category_of_class(shape_.classes - 1, shape_.classes) + 1; }

Yolov5Output Yolov5::forward(FeatureMap image, Arena& arena) const {
  std::array<FeatureMap, 3> maps = features_(std::move(image), arena);
  if (shape_.fusion) maps = fusion_(maps, arena);
  return head_(maps, arena);
}

ArenaVector<Yolov5Candidate> Yolov5::best_candidates(const Yolov5Output& output, Arena& arena) const {
  ArenaVector<Yolov5Candidate> best(arena, static_cast<std::size_t>(std::max(config_.max_detections, 0)));
  const ArenaVector<Yolov5Candidate> found = head_.decode(
      output, config_.score_threshold, static_cast<std::size_t>(std::max(config_.max_candidates, 0)), arena);
  Candidates candidates(arena, found.capacity());
  for (const Yolov5Candidate& candidate : found)
    candidates.add(candidate.box, candidate.score, candidate.label);
  const NmsOptions options{config_.nms_threshold, config_.max_detections, shape_.classes};
  for (const int i : batched_nms(candidates, options, arena)) {
    best.push_back(found[static_cast<std::size_t>(i)]);
  }
  return best;
}

void Yolov5::detect(const ByteView& image, Arena& arena, std::vector<Detection>& detections) const {
  const LetterboxFrame input = letterbox_frame(image, config_.letterbox);
  const Arena::Pass pass(arena, this, input.map_height, input.map_width);
  const Yolov5Output output =
      forward(letterbox_image(image, config_.letterbox, arena, Yolov5Features::kImageBorder), arena);
  const ArenaVector<Yolov5Candidate> candidates = best_candidates(output, arena);

  const auto left = static_cast<float>(input.left), top = static_cast<float>(input.top);
  const auto width = static_cast<float>(image.width), height = static_cast<float>(image.height);
  // Prototypes have a quarter of the input's resolution.
  const PrototypeFrame frame{0.25F * left, 0.25F * top, 0.25F * static_cast<float>(input.width) / width,
                             0.25F * static_cast<float>(input.height) / height};
  const std::size_t prototype_pixels = static_cast<std::size_t>(output.prototypes.height()) *
                                       static_cast<std::size_t>(output.prototypes.width());
  const ArenaBuffer scratch =  // of each thread
      arena.allocate(static_cast<std::size_t>(thread_count()) * prototype_pixels);
  detections.resize(candidates.size());
  parallel_for(candidates.size(), 1, [&](std::size_t d, int slot) {
    const Yolov5Candidate& candidate = candidates[d];
    const Box& box = candidate.box;
    Detection& detection = detections[d];
    detection.box = clip({(box.x1 - left) / input.scale, (box.y1 - top) / input.scale,
                          (box.x2 - left) / input.scale, (box.y2 - top) / input.scale},
                         width, height);
    detection.score = candidate.score;
    detection.label = category_of_class(candidate.label, shape_.classes);
    if (!has_masks()) {
      detection.mask = {};
      return;
    }
    const std::span<float> probabilities(scratch.data() + static_cast<std::size_t>(slot) * prototype_pixels,
                                         prototype_pixels);
    prototype_mask(output.prototypes, head_.coefficients(output, candidate), frame, detection.box,
                   image.width, image.height, config_.mask_threshold, probabilities, detection.mask);
  });
}

}  // namespace penumbra::nn
