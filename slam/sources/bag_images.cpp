#include "slam/sources/bag_images.h"

#include <fmt/core.h>

#include "nn/base/text.h"
#include "slam/sources/bag/image_pixels.h"

namespace penumbra::slam {

ImageKey BagImages::add(const ImageTopic& topic, std::size_t i) {
  std::size_t stream = 0;
  while (stream < streams_.size() && streams_[stream].topic != topic.topic) ++stream;
  if (stream == streams_.size())
    streams_.push_back({topic.topic, printable(topic.name, 100), topic.encoding, topic.is_compressed});
  entries_.push_back({topic.images[i], stream});
  return ImageKey(entries_.size() - 1);
}

std::string BagImages::name(const ImageKey& key) const {
  const Entry& entry = entries_[key.number];
  return fmt::format("{}: {} at {:.6f} s", place_, streams_[entry.stream].name,
                     static_cast<double>(entry.image.time) * 1e-9);
}

template <class Use>
auto BagImages::with_message(const ImageKey& key, const Use& use) const {
  const Entry& entry = entries_[key.number];
  const Stream& stream = streams_[entry.stream];
  const std::string place = name(key);
  const std::string_view bytes = source_->read(entry.image.place);
  return stream.is_compressed ? use(read_compressed_image(bytes, stream.encoding, place), place)
                              : use(read_image_message(bytes, stream.encoding, place), place);
}

nn::StoredImage BagImages::read(const ImageKey& key, nn::ImageColour colour, nn::ImageBits bits) const {
  return with_message(key, [&](const auto& image, const std::string& place) {
    return pixels_of(image, colour, bits, place);
  });
}

nn::ImageInfo BagImages::info(const ImageKey& key) const {
  return with_message(key, [](const auto& image, const std::string& place) { return info_of(image, place); });
}

FloatImage BagImages::depth(const ImageKey& key) const {
  return with_message(key,
                      [](const auto& image, const std::string& place) { return depth_of(image, place); });
}

}  // namespace penumbra::slam
