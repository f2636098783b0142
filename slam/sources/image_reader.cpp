#include "slam/sources/image_reader.h"

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

}  // namespace

std::shared_ptr<const ImageReader> file_images(double depth_factor) {
  return std::make_shared<FileImages>(depth_factor);
}

}  // namespace penumbra::slam
