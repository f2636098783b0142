#include "penumbra/image_file.h"

#include <cstring>

#include "nn/image/image_file.h"

namespace penumbra {

namespace {

template <class T>
ImageFile stored(const Image<T>& image, PixelFormat format) {
  ImageFile file{std::vector<std::byte>(image.elements() * sizeof(T)), image.width(), image.height(), format};
  std::memcpy(file.pixels.data(), image.data(), file.pixels.size());
  return file;
}

}  // namespace

ImageFile read_image(const std::string& path, bool colour) {
  return stored(nn::read_image(path, colour ? nn::ImageColour::bgr : nn::ImageColour::grey),
                colour ? PixelFormat::bgr8 : PixelFormat::grey8);
}

ImageFile read_depth(const std::string& path) {
  return stored(nn::read_depth_image(path), PixelFormat::depth16);
}

}  // namespace penumbra
