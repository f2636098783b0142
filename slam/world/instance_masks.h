// The visible and the whole (amodal) mask of every annotated object in a view.
//
// An instance is all objects of its number. The amodal mask is the object as it would be seen with nothing
// before it, inside the image: each object is cast alone within its own rectangle, which costs about as many
// rays as the objects' rectangles have pixels.
#pragma once

#include <vector>

#include "nn/layers/mask_paste.h"
#include "slam/world/ray_caster.h"

namespace penumbra::slam::synthetic {

struct InstanceMasks {
  int object = 0;  // in World::objects, the first in view where it has several parts
  std::uint16_t instance = 0;
  ObjectClass object_class = ObjectClass::background;
  bool moving = false;
  bool faces_camera = true;  // false: a sign seen from behind
  nn::Mask visible, whole;   // each stored for its own bounding box; `visible` is a part of `whole`
  int visible_area = 0, whole_area = 0;  // pixels

  // Share of the whole mask that something hides.
  float occlusion() const { return 1.0F - static_cast<float>(visible_area) / static_cast<float>(whole_area); }
};

// Every instance of which any pixel lies in the image, also those wholly hidden, in the
// order of their numbers. `view` is what `geometry` was rendered to.
std::vector<InstanceMasks> find_instances(const FrameGeometry& geometry, const RenderedView& view);

}  // namespace penumbra::slam::synthetic
