#include "slam/geometry/stored_camera.h"

#include <cmath>

#include "nn/image/image_container.h"

namespace penumbra::slam {

void put_camera(ByteWriter& out, const StereoCamera& c) {
  for (const double value : {c.fx, c.fy, c.cx, c.cy, c.baseline, c.disparity_offset}) out.put(value);
  for (const std::int32_t value : {c.width, c.height}) out.put(value);
}

StereoCamera get_camera(ByteReader& in) {
  StereoCamera c;
  for (double* value : {&c.fx, &c.fy, &c.cx, &c.cy, &c.baseline, &c.disparity_offset})
    *value = in.get_finite("camera parameter");
  c.width = in.get<std::int32_t>("image width");
  c.height = in.get<std::int32_t>("image height");
  if (!(c.fx > 0.0 && c.fy > 0.0 && c.baseline > 0.0 && c.width > 0 && c.height > 0 &&
        std::abs(c.disparity_offset) < c.width &&
        static_cast<std::int64_t>(c.width) * c.height <= nn::kMaxImagePixels)) {
    in.refuse("focal lengths, baseline and image size above zero, and an image that can be",
              fmt::format("fx {} fy {} baseline {} disparity offset {} size {}x{}", c.fx, c.fy, c.baseline,
                          c.disparity_offset, c.width, c.height));
  }
  return c;
}

}  // namespace penumbra::slam
