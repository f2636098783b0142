// Masks from boxes and depth: a segmenter made of another one, of which only the boxes are used.
//
//   boxes of a detector -> holes in them repaired (depth_repair.h) -> the object in each (object_in_box.h)
//     -> which of them move (moving_consistency.h) -> instances, as those of a network with masks
//
// So they go the way of all masks: through the segmentation thread, late to the keyframes, into the map's
// edits. An object's depth is remembered from image to image, for where a box shows several things.
//
//   a box partly outside the image   is cut off at its border; one wholly outside is left out
//   a box without any depth          stays its own mask; and so is every one of an image without depth
//   depth of another size            InputError
//
// Source: Fang et al. (see depth_repair.h).
#pragma once

#include "slam/dynamics/instance.h"
#include "slam/dynamics/rgbd/depth_repair.h"
#include "slam/dynamics/rgbd/foreground_depths.h"
#include "slam/dynamics/rgbd/moving_consistency.h"
#include "slam/dynamics/rgbd/object_in_box.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

// What is taken for an object: the detector's mask, what the depths in its box say, of all pixels or of the
// feature points (dbscan_masks.h), or the whole box.
enum class InstanceMasks { detector, depth_clusters, dbscan, boxes };

struct DepthMaskSettings {
  InstanceMasks masks = InstanceMasks::detector;
  DepthRepairSettings repair;
  ObjectInBoxSettings object;
  ConsistencySettings consistency;
  ForegroundSettings foreground;
};

// `boxes` finds instances, whose regions are their boxes and may reach beyond the image. Those below
// `least_score` are left out.
Segmenter masks_from_depth(Segmenter boxes, const StereoCamera& camera, double least_score,
                           const DepthMaskSettings& settings);

// The same with each box as the mask: what a detector alone can do.
Segmenter masks_of_boxes(Segmenter boxes);

}  // namespace penumbra::slam
