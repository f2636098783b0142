// Ground truth of a view as images in the formats of the field.
#pragma once

#include <array>

#include "nn/image/image.h"
#include "slam/geometry/trajectory.h"
#include "slam/world/instance_masks.h"

namespace penumbra::slam::synthetic {

// round(per_metre * depth); 0 where there is no depth or it exceeds 65535.
WordImage encode_depth(const FloatImage& depth, float per_metre);

// KITTI's disparity: round(256 fx b / Z), 0 = none (sky). The pixel (u, v) of the left image shows the point
// that the right one, where nothing hides it, shows at (u - disparity, v).
WordImage encode_disparity(const FloatImage& depth, const StereoCamera& camera);

using FlowImage = Image<std::array<float, 3>>;  // (du, dv, valid), pixels

// Motion of every pixel's surface point from the image at `now` to that at `next`, (du, dv, valid): what the
// camera's motion and, on moving objects, their own make of it. Valid is 1 wherever the pixel has a depth and
// the point lies before the camera at `next`, also where it has left the image or something hides it then.
//   u' = project(T_next^-1 M_next M_now^-1 T_now back_project(u, v, Z)),   M = pose of the object, I if still
// `view` must have its objects.
FlowImage optical_flow(const World& world, const StereoCamera& camera, const RenderedView& view,
                       const TimedPose& now, const TimedPose& next);

// KITTI's 16-bit flow, the last channel first: valid, 64 dv + 32768, 64 du + 32768. Motion beyond +-511
// pixels is marked invalid.
WordImage encode_flow(const FlowImage& flow);

// 255 on the mask, 0 elsewhere.
ByteImage mask_image(const nn::Mask& mask, const Size& size);

}  // namespace penumbra::slam::synthetic
