#include "slam/dynamics/rgbd/depth_masks.h"

#include <memory>
#include <utility>

#include "nn/image/grey.h"
#include "slam/dynamics/rgbd/box_instances.h"

namespace penumbra::slam {

namespace {

constexpr double kSameObject = 0.3;  // least IoU of boxes
constexpr int kLongestMemory = 15;   // frames

double box_iou(const Rect& a, const Rect& b) {
  const int shared = intersection(a, b).area();
  return shared / static_cast<double>(std::max(1, a.area() + b.area() - shared));
}

// Where an object was.
struct Memory {
  std::string class_name;
  Rect region;
  double depth = 0.0;  // metres
  int frame = 0;
};

class DepthMasks {
 public:
  DepthMasks(Segmenter boxes, const StereoCamera& camera, double least_score,
             const DepthMaskSettings& settings)
      : boxes_(std::move(boxes)),
        least_score_(least_score),
        consistency_enabled_(settings.consistency.enabled),
        repair_(settings.repair),
        object_(camera.fx, settings.object),
        consistency_(settings.consistency) {}

  std::vector<Instance> operator()(const ImageToSegment& from) {
    check_depth_size(from);
    std::vector<Instance> instances = boxes_(from);
    keep_inside(from.image.size(), least_score_, instances);
    const ByteImage grey = to_grey(from.image);
    if (!from.depth.empty()) {
      depth_.create(from.depth.width(), from.depth.height());
      std::copy_n(from.depth.data(), from.depth.elements(), depth_.data());
      for (const Instance& instance : instances) repair_.apply(grey, instance.region, depth_);
    }
    now_.clear();
    for (Instance& instance : instances) {
      if (from.depth.empty()) {
        take_whole_box(instance);
        continue;
      }
      object_.find(from.image, depth_, instance.region, past_depth(instance, from.frame), found_);
      instance.mask = found_.mask.clone();
      if (found_.depth > 0.0)
        now_.push_back({instance.class_name, instance.region, found_.depth, from.frame});
    }
    std::swap(past_, now_);
    if (consistency_enabled_) tell_motions(from.frame, grey, instances);
    return instances;
  }

 private:
  std::optional<double> past_depth(const Instance& instance, int frame) const {
    std::optional<double> depth;
    double best = kSameObject;
    for (const Memory& memory : past_) {
      const double iou = box_iou(memory.region, instance.region);
      if (memory.class_name != instance.class_name || frame - memory.frame > kLongestMemory || iou < best)
        continue;
      best = iou;
      depth = memory.depth;
    }
    return depth;
  }

  void tell_motions(int frame, const ByteImage& grey, std::vector<Instance>& instances) {
    const std::vector<PointMotions>& motions = consistency_.check(frame, grey, instances);
    for (std::size_t i = 0; i < instances.size(); ++i) {
      if (consistency_.tells(motions[i])) instances[i].moves = consistency_.moves(motions[i]);
    }
  }

  const Segmenter boxes_;
  const double least_score_;
  const bool consistency_enabled_;
  DepthRepair repair_;
  ObjectInBox object_;
  MovingConsistency consistency_;
  FloatImage depth_;  // repaired
  ObjectMask found_;
  std::vector<Memory> past_, now_;
};

}  // namespace

Segmenter masks_from_depth(Segmenter boxes, const StereoCamera& camera, double least_score,
                           const DepthMaskSettings& settings) {
  const auto masks = std::make_shared<DepthMasks>(std::move(boxes), camera, least_score, settings);
  return [masks](const ImageToSegment& from) { return (*masks)(from); };
}

Segmenter masks_of_boxes(Segmenter boxes) {
  return [boxes = std::move(boxes)](const ImageToSegment& from) {
    std::vector<Instance> instances = boxes(from);
    keep_inside(from.image.size(), 0.0, instances);
    for (Instance& instance : instances) take_whole_box(instance);
    return instances;
  };
}

}  // namespace penumbra::slam
