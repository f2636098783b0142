// A camera as bytes of our own file formats: fx fy cx cy baseline, disparity offset f64, width height i32.
#pragma once

#include "nn/base/byte_stream.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

void put_camera(ByteWriter& out, const StereoCamera& camera);
// Throws InputError naming the byte for a camera that cannot be: numbers that are not finite, focal lengths,
// baseline or image size of 0 or less, a disparity offset or an image that is too large.
StereoCamera get_camera(ByteReader& in);

}  // namespace penumbra::slam
