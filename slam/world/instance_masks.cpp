#include "slam/world/instance_masks.h"

#include <algorithm>
#include <map>

#include "nn/base/parallel.h"

namespace penumbra::slam::synthetic {

namespace {

// The part of `mask` inside its smallest rectangle, at an offset of (x, y) in the image.
nn::Mask cropped(const ByteImage& mask, int x, int y, int& area) {
  int left = mask.width(), right = -1, top = mask.height(), bottom = -1;
  area = 0;
  for (int row = 0; row < mask.height(); ++row) {
    const std::uint8_t* bits = mask.row(row);
    for (int column = 0; column < mask.width(); ++column) {
      if (bits[column] == 0) continue;
      ++area;
      left = std::min(left, column);
      right = std::max(right, column);
      top = std::min(top, row);
      bottom = row;
    }
  }
  nn::Mask result;
  if (area == 0) return result;
  result = {x + left, y + top, right - left + 1, bottom - top + 1, {}};
  for (int row = top; row <= bottom; ++row) {
    result.bits.insert(result.bits.end(), mask.row(row) + left, mask.row(row) + right + 1);
  }
  return result;
}

// Of the instance whose parts are frame objects `numbers`.
InstanceMasks masks_of(const FrameGeometry& geometry, const std::vector<int>& numbers,
                       const RenderedView& view) {
  const FrameObject& placed = geometry.frame_object(numbers.front());
  const Object& object = geometry.world().objects[static_cast<std::size_t>(placed.object)];
  const StereoCamera& camera = geometry.camera();
  Rect pixels;
  for (const int number : numbers) pixels = bounding(pixels, geometry.pixels_of(number));
  ByteImage whole(pixels.width, pixels.height), visible(pixels.width, pixels.height);
  RayBatch batch;
  for (int row = 0; row < pixels.height; ++row) {
    for (int from = 0; from < pixels.width; from += kTileWidth) {
      const int count = std::min(kTileWidth, pixels.width - from);
      for (int i = 0; i < count; ++i) {
        batch.x[i] = static_cast<float>((pixels.x + from + i - camera.cx) / camera.fx);
        batch.y[i] = static_cast<float>((pixels.y + row - camera.cy) / camera.fy);
      }
      geometry.cast_alone(numbers, batch, count);
      for (int i = 0; i < count; ++i) {
        const bool hit = batch.surface[i] != kSky;
        const bool seen = hit && view.instance.at(pixels.x + from + i, pixels.y + row) == object.instance;
        whole.at(from + i, row) = hit ? 1 : 0;
        visible.at(from + i, row) = seen ? 1 : 0;
      }
    }
  }
  InstanceMasks masks;
  masks.object = placed.object;
  masks.instance = object.instance;
  masks.object_class = object.object_class;
  masks.moving = object.motion.moves;
  masks.faces_camera = object.object_class != ObjectClass::sign || placed.camera_in_local.z() < 0.0F;
  masks.whole = cropped(whole, pixels.x, pixels.y, masks.whole_area);
  masks.visible = cropped(visible, pixels.x, pixels.y, masks.visible_area);
  return masks;
}

}  // namespace

std::vector<InstanceMasks> find_instances(const FrameGeometry& geometry, const RenderedView& view) {
  std::map<std::uint16_t, std::vector<int>> parts;  // frame objects of each instance
  for (int i = 0; i < geometry.frame_objects(); ++i) {
    const FrameObject& placed = geometry.frame_object(i);
    const std::uint16_t instance = geometry.world().objects[static_cast<std::size_t>(placed.object)].instance;
    if (instance != 0 && !geometry.pixels_of(i).empty()) parts[instance].push_back(i);
  }
  std::vector<const std::vector<int>*> lists;
  for (const auto& [instance, numbers] : parts) lists.push_back(&numbers);
  std::vector<InstanceMasks> instances(lists.size());
  parallel_for(lists.size(), 1, [&](std::size_t k) { instances[k] = masks_of(geometry, *lists[k], view); });
  std::erase_if(instances, [](const InstanceMasks& masks) { return masks.whole_area == 0; });
  return instances;
}

}  // namespace penumbra::slam::synthetic
