#include "nn/models/yolov5_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "nn/layers/activations.h"
#include "nn/layers/upsample.h"

namespace penumbra::nn {

namespace {

const std::string kHead = "model.24.";
constexpr std::array<int, 3> kStrides{8, 16, 32};
// Width and height in pixels, three a level.
constexpr std::array<std::array<float, 6>, 3> kCocoAnchors{
    {{10, 13, 16, 30, 33, 23}, {30, 61, 62, 45, 59, 119}, {116, 90, 156, 198, 373, 326}}};

// Channel c of a pixel, whose first channels are `pixel` and whose blocks are `block_stride` apart.
float channel(const float* pixel, std::ptrdiff_t block_stride, int c) {
  return pixel[c / kBlock * block_stride + c % kBlock];
}

float square(float x) { return x * x; }

// The order in which decode meets candidates.
bool earlier(const Yolov5Candidate& a, const Yolov5Candidate& b) {
  return std::tie(a.level, a.anchor, a.row, a.column, a.label) <
         std::tie(b.level, b.anchor, b.row, b.column, b.label);
}

bool better(const Yolov5Candidate& a, const Yolov5Candidate& b) {
  return a.score != b.score ? a.score > b.score : earlier(a, b);
}

// `heap` has the worst on top.
void replace_worst(ArenaVector<Yolov5Candidate>& heap, const Yolov5Candidate& candidate) {
  if (heap.empty() || !better(candidate, *heap.begin())) return;
  std::pop_heap(heap.begin(), heap.end(), better);
  heap[heap.size() - 1] = candidate;
  std::push_heap(heap.begin(), heap.end(), better);
}

}  // namespace

Yolov5Head::Yolov5Head(WeightReader& weights, const Yolov5Shape& shape)
    : classes_(shape.classes), masks_(shape.masks) {
  std::vector<float> stored;
  if (weights.has(kHead + "anchors"))
    stored = weights.tensor(kHead + "anchors", {3, kAnchorsPerCell, 2}).values;
  if (weights.has(kHead + "anchor_grid")) weights.ignore(kHead + "anchor_grid");  // the same, in pixels
  for (std::size_t level = 0; level < 3; ++level) {
    const auto stride = static_cast<float>(kStrides[level]);
    for (std::size_t a = 0; a < kAnchorsPerCell; ++a) {
      const float* cells = stored.empty() ? nullptr : &stored[(level * kAnchorsPerCell + a) * 2];
      anchors_[level][a] = cells != nullptr
                               ? Anchor{cells[0] * stride, cells[1] * stride}
                               : Anchor{kCocoAnchors[level][2 * a], kCocoAnchors[level][2 * a + 1]};
    }
    const int inputs = shape.channels[2 + level], outputs = kAnchorsPerCell * values();
    const std::string name = fmt::format("{}m.{}.", kHead, level);
    predictors_[level] = Conv2d(weights.tensor(name + "weight", {outputs, inputs, 1, 1}),
                                weights.vector(name + "bias", outputs), {});
  }
  if (!masks_) return;
  const int hidden = shape.prototype_channels;
  prototype1_ = yolov5_conv(weights, kHead + "proto.cv1", {shape.channels[2], hidden, 3});
  prototype2_ = yolov5_conv(weights, kHead + "proto.cv2", {hidden, hidden, 3});
  prototype3_ = yolov5_conv(weights, kHead + "proto.cv3", {hidden, kPrototypes});
}

Yolov5Output Yolov5Head::operator()(const std::array<FeatureMap, 3>& maps, Arena& arena) const {
  Yolov5Output output;
  for (std::size_t level = 0; level < 3; ++level)
    output.levels[level] = predictors_[level](maps[level], arena);
  if (masks_) {
    const FeatureMap fine = upsample_nearest(prototype1_(maps[0], arena), 2, arena, 1);
    output.prototypes = prototype3_(prototype2_(fine, arena), arena);
  }
  return output;
}

ArenaVector<Yolov5Candidate> Yolov5Head::decode(const Yolov5Output& output, float threshold,
                                                std::size_t capacity, Arena& arena) const {
  ArenaVector<Yolov5Candidate> candidates(arena, capacity);
  bool chosen = false;  // not all had room
  for (std::size_t level = 0; level < 3; ++level) {
    const FeatureMap& map = output.levels[level];
    const auto stride = static_cast<float>(kStrides[level]);
    const std::ptrdiff_t blocks = map.block_stride();
    for (int a = 0; a < kAnchorsPerCell; ++a) {
      const Anchor& anchor = anchors_[level][static_cast<std::size_t>(a)];
      const int first = a * values();
      for (int row = 0; row < map.height(); ++row) {
        for (int column = 0; column < map.width(); ++column) {
          const float* pixel = map.pixel(0, 0, row, column);
          const auto t = [&](int value) { return sigmoid(channel(pixel, blocks, first + value)); };
          const float objectness = t(4);
          if (!(objectness > threshold)) continue;
          const float x = (2.0F * t(0) - 0.5F + static_cast<float>(column)) * stride;
          const float y = (2.0F * t(1) - 0.5F + static_cast<float>(row)) * stride;
          const float half_width = square(2.0F * t(2)) * anchor.width * 0.5F;
          const float half_height = square(2.0F * t(3)) * anchor.height * 0.5F;
          const Box box{x - half_width, y - half_height, x + half_width, y + half_height};
          for (int c = 0; c < classes_; ++c) {
            const float score = objectness * t(kBoxValues + c);
            if (!(score > threshold)) continue;
            const Yolov5Candidate candidate{box, score, c, static_cast<int>(level), a, row, column};
            if (candidates.size() < capacity) {
              candidates.push_back(candidate);
            } else {
              if (!chosen) std::make_heap(candidates.begin(), candidates.end(), better);
              chosen = true;
              replace_worst(candidates, candidate);
            }
          }
        }
      }
    }
  }
  if (chosen) std::sort(candidates.begin(), candidates.end(), earlier);
  return candidates;
}

std::array<float, kPrototypes> Yolov5Head::coefficients(const Yolov5Output& output,
                                                        const Yolov5Candidate& candidate) const {
  const FeatureMap& map = output.levels[static_cast<std::size_t>(candidate.level)];
  const float* pixel = map.pixel(0, 0, candidate.row, candidate.column);
  const int first = candidate.anchor * values() + kBoxValues + classes_;
  std::array<float, kPrototypes> coefficients;
  for (int k = 0; k < kPrototypes; ++k) {
    coefficients[static_cast<std::size_t>(k)] = channel(pixel, map.block_stride(), first + k);
  }
  return coefficients;
}

}  // namespace penumbra::nn
