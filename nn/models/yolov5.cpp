#include "nn/models/yolov5.h"

#include <algorithm>

#include "nn/layers/nms.h"
#include "nn/layers/prototype_mask.h"
#include "nn/models/coco_categories.h"

namespace penumbra::nn {

Yolov5::Yolov5(const StateDict& state_dict, Yolov5Config config) : config_(config) {
  WeightReader weights(state_dict);
  shape_ = yolov5_shape(weights);
  features_ = Yolov5Features(weights, shape_);
  head_ = Yolov5Head(weights, shape_);
  weights.finish(shape_.name());
}

int Yolov5::classes() const { return category_of_class(shape_.classes - 1, shape_.classes) + 1; }

Yolov5Output Yolov5::forward(const FeatureMap& image, Arena& arena) const {
  return head_(features_(image, arena), arena);
}

std::vector<Yolov5Candidate> Yolov5::best_candidates(const Yolov5Output& output) const {
  std::vector<Yolov5Candidate> candidates = head_.decode(output, config_.score_threshold);
  const auto limit = static_cast<std::size_t>(config_.max_candidates);
  if (candidates.size() > limit) {
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const auto& a, const auto& b) { return a.score > b.score; });
    candidates.resize(limit);
  }
  std::vector<Box> boxes;
  std::vector<float> scores;
  std::vector<int> labels;
  for (const Yolov5Candidate& candidate : candidates) {
    boxes.push_back(candidate.box);
    scores.push_back(candidate.score);
    labels.push_back(candidate.label);
  }
  std::vector<Yolov5Candidate> best;
  for (const int i : batched_nms(boxes, scores, labels, config_.nms_threshold, config_.max_detections)) {
    best.push_back(candidates[static_cast<std::size_t>(i)]);
  }
  return best;
}

std::vector<Detection> Yolov5::detect(const cv::Mat& image, Arena& arena) const {
  const LetterboxedImage input =
      letterbox_image(image, config_.letterbox, arena, Yolov5Features::kImageBorder);
  const Yolov5Output output = forward(input.map, arena);
  const std::vector<Yolov5Candidate> candidates = best_candidates(output);

  const auto left = static_cast<float>(input.left), top = static_cast<float>(input.top);
  const auto width = static_cast<float>(image.cols), height = static_cast<float>(image.rows);
  // Prototypes have a quarter of the input's resolution.
  const PrototypeFrame frame{0.25F * left, 0.25F * top, 0.25F * static_cast<float>(input.width) / width,
                             0.25F * static_cast<float>(input.height) / height};
  std::vector<Detection> detections(candidates.size());
#pragma omp parallel for schedule(dynamic)
  for (std::size_t d = 0; d < candidates.size(); ++d) {
    const Yolov5Candidate& candidate = candidates[d];
    const Box& box = candidate.box;
    Detection& detection = detections[d];
    detection.box = clip({(box.x1 - left) / input.scale, (box.y1 - top) / input.scale,
                          (box.x2 - left) / input.scale, (box.y2 - top) / input.scale},
                         width, height);
    detection.score = candidate.score;
    detection.label = category_of_class(candidate.label, shape_.classes);
    if (!has_masks()) continue;
    detection.mask = prototype_mask(output.prototypes, head_.coefficients(output, candidate), frame,
                                    detection.box, image.cols, image.rows, config_.mask_threshold);
  }
  return detections;
}

}  // namespace penumbra::nn
