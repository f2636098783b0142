#include "slam/dynamics/rgbd/dbscan_masks.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "slam/dynamics/rgbd/box_instances.h"
#include "slam/frontend/features/frame_features.h"

namespace penumbra::slam {

namespace {

Rect with_ring(const Rect& box, double share) {
  const int x = static_cast<int>(std::lround(share * box.width));
  const int y = static_cast<int>(std::lround(share * box.height));
  return {box.x - x, box.y - y, box.width + 2 * x, box.height + 2 * y};
}

// 255 from `first` to before `end` where `inside`.
void paint_run(std::uint8_t* row, int first, int end, bool inside) {
  if (inside) std::fill(row + first, row + end, std::uint8_t{255});
}

// A pixel without depth goes with the nearest one that has one, in its row.
void paint_row(const float* depth, int width, const DepthRange& range, std::uint8_t* mask) {
  int last = -1;  // pixel with depth
  bool last_inside = true;
  for (int x = 0; x < width; ++x) {
    if (!(depth[x] > 0.0F)) continue;
    const bool inside = range.contains(depth[x]);
    const int middle = last < 0 ? 0 : (last + x) / 2 + 1;
    paint_run(mask, last + 1, middle, last_inside);
    paint_run(mask, middle, x, inside);
    mask[x] = inside ? 255 : 0;
    last = x;
    last_inside = inside;
  }
  paint_run(mask, last + 1, width, last_inside);
}

class DbscanMasks {
 public:
  DbscanMasks(Segmenter boxes, double least_score, const ForegroundSettings& settings)
      : boxes_(std::move(boxes)),
        least_score_(least_score),
        ring_share_(settings.ring_share),
        margin_(settings.mode == ForegroundMode::paper ? 0.0F : 0.5F * static_cast<float>(settings.eps)),
        foreground_(settings) {}

  std::vector<Instance> operator()(const ImageToSegment& from) {
    check_depth_size(from);
    std::vector<Instance> instances = boxes_(from);
    keep_inside(from.image.size(), least_score_, instances);
    for (Instance& instance : instances) {
      const std::optional<DepthRange> range = range_of(from, instance, instances);
      if (!range) {
        take_whole_box(instance);
        continue;
      }
      const Rect& box = instance.region;
      instance.mask = ByteImage::filled(box.width, box.height, 0);
      const DepthRange wide{range->nearest * (1.0F - margin_), range->farthest * (1.0F + margin_)};
      for (int y = 0; y < box.height; ++y)
        paint_row(from.depth.row(box.y + y) + box.x, box.width, wide, instance.mask.row(y));
    }
    return instances;
  }

 private:
  // Of the person's depths. Other boxes say nothing of what goes on around this one.
  std::optional<DepthRange> range_of(const ImageToSegment& from, const Instance& instance,
                                     const std::vector<Instance>& all) {
    if (from.depth.empty() || from.features == nullptr) return std::nullopt;
    in_box_.clear();
    in_ring_.clear();
    const Rect ring = with_ring(instance.region, ring_share_);
    for (int i = 0; i < from.features->size(); ++i) {
      const float depth = from.features->depth[static_cast<std::size_t>(i)];
      if (!(depth > 0.0F)) continue;
      const Keypoint& k = from.features->keypoint(i);
      const int x = static_cast<int>(k.u), y = static_cast<int>(k.v);
      if (!ring.contains(x, y)) continue;
      if (instance.region.contains(x, y)) {
        in_box_.push_back(depth);
      } else if (std::none_of(all.begin(), all.end(),
                              [&](const Instance& other) { return other.region.contains(x, y); })) {
        in_ring_.push_back(depth);
      }
    }
    return foreground_.find(in_box_, in_ring_);
  }

  const Segmenter boxes_;
  const double least_score_, ring_share_;
  const float margin_;  // of the depth: surfaces go on a little beyond their features
  ForegroundDepths foreground_;
  std::vector<float> in_box_, in_ring_;
};

}  // namespace

Segmenter masks_by_dbscan(Segmenter boxes, double least_score, const ForegroundSettings& settings) {
  const auto masks = std::make_shared<DbscanMasks>(std::move(boxes), least_score, settings);
  return [masks](const ImageToSegment& from) { return (*masks)(from); };
}

}  // namespace penumbra::slam
