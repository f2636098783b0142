// Where the images of a recording are read from: files of their own, or messages in one file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "nn/image/bayer.h"
#include "nn/image/image_file.h"
#include "nn/image/stored_image.h"

namespace penumbra::slam {

// One image: a file, or else the number of a message.
struct ImageKey {
  ImageKey() = default;
  ImageKey(std::filesystem::path path) : file(std::move(path)) {}
  explicit ImageKey(std::size_t message) : number(message) {}

  std::filesystem::path file;
  std::size_t number = 0;
};

// Each function throws InputError, naming the image, for one that is missing or torn. One call at a time.
class ImageReader {
 public:
  virtual ~ImageReader() = default;
  // For messages.
  virtual std::string name(const ImageKey& key) const = 0;
  // As nn::read_image and nn::read_stored_image, the sensor's rows.
  virtual nn::StoredImage read(const ImageKey& key, nn::ImageColour colour, nn::ImageBits bits) const = 0;
  virtual nn::ImageInfo info(const ImageKey& key) const = 0;
  // Metres along z, 0 where unknown.
  virtual FloatImage depth(const ImageKey& key) const = 0;
};

// Files; `depth_factor`: levels a metre of depth images.
std::shared_ptr<const ImageReader> file_images(double depth_factor = 1.0);
// Files whose pixels stood behind a mosaic of filters, where they have one channel; files in colour as they
// are.
std::shared_ptr<const ImageReader> mosaic_images(BayerPattern pattern);

}  // namespace penumbra::slam
