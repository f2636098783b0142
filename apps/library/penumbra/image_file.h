// Reads images from files, for programs that have no reader of their own: PNG, JPEG, PGM / PPM, BMP.
//
//   const penumbra::ImageFile left = penumbra::read_image("left/000000.png");
//   slam.track({.timestamp = 0.0, .left = left.view(), .right = right.view()});
//
// Errors are std::runtime_error that names the file.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "penumbra/export.h"
#include "penumbra/image.h"

namespace penumbra {

struct ImageFile {
  std::vector<std::byte> pixels = {};
  int width = 0, height = 0;
  PixelFormat format = PixelFormat::grey8;

  ImageRef view() const { return {pixels.data(), width, height, format, 0}; }
};

// As grey8, or with `colour` as bgr8.
PENUMBRA_API ImageFile read_image(const std::string& path, bool colour = false);
// A 16-bit PNG, as depth16.
PENUMBRA_API ImageFile read_depth(const std::string& path);

}  // namespace penumbra
