// RoIAlign, NMS, boxes, anchors and mask paste on the cases of tests/fixtures/layers.
#include <cmath>

#include "nn/layers/anchor_generator.h"
#include "nn/layers/box_coder.h"
#include "nn/layers/nms.h"
#include "nn/layers/reference/reference.h"
#include "tests/nn/layers/pytorch_cases.h"

namespace penumbra::nn {

using test::LayerCase;

namespace {

Tensor boxes_tensor(const std::vector<Box>& boxes) {
  Tensor tensor({static_cast<std::int64_t>(boxes.size()), 4}, {});
  for (const Box& box : boxes) tensor.values.insert(tensor.values.end(), {box.x1, box.y1, box.x2, box.y2});
  return tensor;
}

}  // namespace

Outputs roi_align_case(const LayerCase& c, Arena& arena) {
  const Tensor x = c.input("x");
  const std::vector<Box> boxes = c.boxes("regions");
  const RoiAlignOptions options{c.option("size"), c.option("sampling"), c.option<bool>("aligned")};
  const float scale = c.option<float>("scale");
  return {to_tensor(roi_align(to_feature_map(x, arena), scale, boxes, options, arena)),
          reference::roi_align(x, scale, boxes, options)};
}

Outputs multi_scale_roi_align_case(const LayerCase& c, Arena& arena) {
  const std::vector<Tensor> inputs{c.input("p2"), c.input("p3"), c.input("p4"), c.input("p5")};
  const RoiAlignOptions options{c.option("size"), c.option("sampling"), false};
  std::vector<Box> boxes = c.boxes("regions");
  for (Box& box : boxes) box = {8 * box.x1, 8 * box.y1, 8 * box.x2, 8 * box.y2};
  std::vector<FeatureMap> maps;
  for (const Tensor& input : inputs) maps.push_back(to_feature_map(input, arena));
  std::vector<PyramidLevel> levels;
  for (std::size_t k = 0; k < maps.size(); ++k)
    levels.push_back({&maps[k], 0.25F / static_cast<float>(1U << k)});
  Tensor naive({0, inputs[0].extent(1), options.size, options.size});
  for (const Box& box : boxes) {
    const auto k = static_cast<std::size_t>(roi_level(box, 4));
    const Tensor one = reference::roi_align(inputs[k], levels[k].scale, {&box, 1}, options);
    naive.values.insert(naive.values.end(), one.values.begin(), one.values.end());
    naive.shape[0] += 1;
  }
  return {to_tensor(multi_scale_roi_align(levels, boxes, options, arena)), naive};
}

Outputs nms_case(const LayerCase& c, Arena&) {
  const std::vector<Box> boxes = c.boxes("regions");
  std::vector<int> groups;
  for (const float u : c.values("groups"))
    groups.push_back(static_cast<int>(std::floor(2 * u)) + 2);  // -2..1 to 0..3
  const auto as_tensor = [](const std::vector<int>& kept) {
    return Tensor({static_cast<std::int64_t>(kept.size())}, {kept.begin(), kept.end()});
  };
  const float threshold = c.option<float>("threshold");
  return {as_tensor(batched_nms(boxes, c.values("scores"), groups, threshold, 1000)),
          as_tensor(reference::batched_nms(boxes, c.values("scores"), groups, threshold, 1000))};
}

Outputs decode_box_case(const LayerCase& c, Arena&) {
  const auto k = c.option<std::vector<float>>("weights");
  const std::vector<float> d = c.values("deltas");
  std::vector<Box> boxes = c.boxes("regions");
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const float* delta = d.data() + 4 * i;
    boxes[i] = decode_box(boxes[i], 3 * delta[0], 3 * delta[1], 3 * delta[2], 3 * delta[3],
                          {k[0], k[1], k[2], k[3]});
  }
  return {boxes_tensor(boxes), boxes_tensor(boxes)};
}

Outputs base_anchors_case(const LayerCase& c, Arena&) {
  const Tensor boxes =
      boxes_tensor(base_anchors(c.option<float>("scale"), c.option<std::vector<float>>("ratios")));
  return {boxes, boxes};
}

Outputs mask_paste_case(const LayerCase& c, Arena&) {
  constexpr int kSize = 28, kWidth = 60, kHeight = 50;
  const std::vector<float> u = c.values("masks");
  Tensor fast({0, 1, kHeight, kWidth}), naive = fast;
  for (const Box& region : c.boxes("regions")) {
    std::vector<float> probabilities;
    for (int i = 0; i < kSize * kSize; ++i) {
      probabilities.push_back(0.5F + 0.5F * u[static_cast<std::size_t>(fast.extent(0) * kSize * kSize + i)]);
    }
    const Box box = clip(region, kWidth, kHeight);
    const Mask mask = paste_mask(probabilities, kSize, box, kWidth, kHeight);
    for (int i = 0; i < kHeight * kWidth; ++i) fast.values.push_back(mask.contains(i % kWidth, i / kWidth));
    const auto bits = reference::paste_mask(probabilities, kSize, box, kWidth, kHeight, 0.5F);
    naive.values.insert(naive.values.end(), bits.begin(), bits.end());
    naive.shape[0] = fast.shape[0] += 1;
  }
  return {fast, naive};
}

}  // namespace penumbra::nn
