// A frame's features as they are known by now: what was measured in its images, which never changes, and
// beside it what was found out later.
//
//   pixels    where each feature's patch was found, to a tenth of a pixel (slam/frontend/locating)
//   movable   which features lie on something that moves: kept out of the pose and of the map
//
// Whoever locates a frame, and then its keyframe, owns these two; a view only refers to them. It costs
// nothing to make and is passed by value or reference as the features themselves would be.
#pragma once

#include <memory>
#include <vector>

#include "slam/frontend/features/frame_features.h"

namespace penumbra::slam {

// Where a feature is, pixels of the full images: column and row in the left one, column in the right one (-1
// where there is no stereo match).
struct FeaturePixel {
  float u = 0.0F, v = 0.0F, u_right = -1.0F;
};

// Entry i of every vector belongs to feature i.
using FeaturePixels = std::vector<FeaturePixel>;

class FeatureView {
 public:
  // As they were measured, nothing of it known to move.
  FeatureView(const FrameFeatures& measured) : measured_(&measured) {}
  // `pixels`, `movable`: per feature; empty where nothing is known beside what was measured.
  FeatureView(const FrameFeatures& measured, const std::vector<char>& movable)
      : measured_(&measured), movable_(movable.empty() ? nullptr : movable.data()) {}
  FeatureView(const FrameFeatures& measured, const FeaturePixels& pixels, const std::vector<char>& movable)
      : measured_(&measured),
        pixels_(pixels.empty() ? nullptr : pixels.data()),
        movable_(movable.empty() ? nullptr : movable.data()) {}
  FeatureView(const FrameFeatures& measured, const std::shared_ptr<const FeaturePixels>& pixels,
              const std::vector<char>& movable)
      : measured_(&measured),
        pixels_(pixels == nullptr || pixels->empty() ? nullptr : pixels->data()),
        movable_(movable.empty() ? nullptr : movable.data()) {}

  const FrameFeatures& measured() const { return *measured_; }
  int size() const { return measured_->size(); }
  const Descriptor& descriptor(int i) const { return measured_->descriptor(i); }
  int level(int i) const { return measured_->keypoint(i).level; }
  bool has_stereo(int i) const { return measured_->has_stereo(i); }
  // Metres; -1 without stereo match.
  float depth(int i) const { return measured_->depth[static_cast<std::size_t>(i)]; }
  bool is_movable(int i) const { return movable_ != nullptr && movable_[i] != 0; }

  FeaturePixel pixel(int i) const { return pixels_ != nullptr ? pixels_[i] : measured_pixel(*measured_, i); }
  // The keypoint at its pixel.
  Keypoint keypoint(int i) const {
    Keypoint k = measured_->keypoint(i);
    if (pixels_ != nullptr) {
      k.u = pixels_[i].u;
      k.v = pixels_[i].v;
    }
    return k;
  }
  float u_right(int i) const { return pixel(i).u_right; }

  static FeaturePixel measured_pixel(const FrameFeatures& measured, int i) {
    const Keypoint& k = measured.keypoint(i);
    return {k.u, k.v, measured.u_right[static_cast<std::size_t>(i)]};
  }

 private:
  const FrameFeatures* measured_;
  const FeaturePixel* pixels_ = nullptr;
  const char* movable_ = nullptr;
};

}  // namespace penumbra::slam
