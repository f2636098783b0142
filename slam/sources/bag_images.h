// The images of a recording in one file, by number.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "slam/sources/bag/bag_index.h"
#include "slam/sources/image_reader.h"

namespace penumbra::slam {

class BagImages final : public ImageReader {
 public:
  BagImages(std::unique_ptr<MessageSource> source, std::string place)
      : source_(std::move(source)), place_(std::move(place)) {}

  // The key of image `i` of a topic, whose images need not be kept.
  ImageKey add(const ImageTopic& topic, std::size_t i);

  std::string name(const ImageKey& key) const override;
  nn::StoredImage read(const ImageKey& key, nn::ImageColour colour, nn::ImageBits bits) const override;
  nn::ImageInfo info(const ImageKey& key) const override;
  FloatImage depth(const ImageKey& key) const override;

 private:
  struct Stream {
    std::size_t topic = 0;
    std::string name;
    MessageEncoding encoding{};
    bool is_compressed = false;
  };
  struct Entry {
    IndexedImage image;
    std::size_t stream = 0;
  };
  // Calls `use` with the message as what it is.
  template <class Use>
  auto with_message(const ImageKey& key, const Use& use) const;

  std::unique_ptr<MessageSource> source_;  // of which read() is used alone
  std::string place_;
  std::vector<Stream> streams_;
  std::vector<Entry> entries_;
};

}  // namespace penumbra::slam
