#include "slam/sources/image_reader.h"

#include <fmt/core.h>

#include "nn/base/error.h"
#include "nn/image/grey.h"
#include "nn/image/levels.h"

namespace penumbra::slam {

namespace {

class FileImages final : public ImageReader {
 public:
  explicit FileImages(double depth_factor) : depth_factor_(depth_factor) {}

  std::string name(const ImageKey& key) const override { return key.file.string(); }
  nn::StoredImage read(const ImageKey& key, nn::ImageColour colour, nn::ImageBits bits) const override {
    return nn::read_image_bits(key.file, colour, bits);
  }
  nn::ImageInfo info(const ImageKey& key) const override { return nn::read_image_info(key.file); }
  FloatImage depth(const ImageKey& key) const override {
    return metres_of(nn::read_depth_image(key.file), depth_factor_);
  }

 private:
  double depth_factor_;
};

class MosaicImages final : public ImageReader {
 public:
  explicit MosaicImages(BayerPattern pattern) : pattern_(pattern) {}

  std::string name(const ImageKey& key) const override { return key.file.string(); }
  nn::StoredImage read(const ImageKey& key, nn::ImageColour colour, nn::ImageBits) const override {
    nn::StoredImage image = nn::read_image_bits(key.file, nn::ImageColour::stored, nn::ImageBits::eight);
    const Size size = image.size();
    if (size.width < 2 || size.height < 2)
      throw InputError(name(key), "an image of at least 2 x 2 pixels",
                       fmt::format("{} x {}", size.width, size.height));
    if (image.channels() == 1) image.bytes = demosaic(image.bytes, pattern_);
    if (colour == nn::ImageColour::grey) image.bytes = to_grey(image.bytes);
    return image;
  }
  nn::ImageInfo info(const ImageKey& key) const override { return nn::read_image_info(key.file); }
  FloatImage depth(const ImageKey& key) const override {
    throw InputError(name(key), "an image with depth", "a mosaic of filters");
  }

 private:
  BayerPattern pattern_;
};

}  // namespace

std::shared_ptr<const ImageReader> mosaic_images(BayerPattern pattern) {
  return std::make_shared<MosaicImages>(pattern);
}

std::shared_ptr<const ImageReader> file_images(double depth_factor) {
  return std::make_shared<FileImages>(depth_factor);
}

}  // namespace penumbra::slam
