// Readers of images: the walk through a file's chunks or markers, the decoder behind it, and COCO's masks.
#include <numeric>

#include "nn/evaluation/coco_rle.h"
#include "nn/image/image_container.h"
#include "nn/image/image_file.h"
#include "tests/fuzz/memory_file.h"
#include "tests/fuzz/repair.h"
#include "tests/fuzz/target.h"

namespace penumbra::fuzz {

namespace {

void require_size(const nn::ImageInfo& size) {
  require(size.width > 0 && size.height > 0, "an image has pixels");
  require(static_cast<long>(size.width) * size.height <= nn::kMaxImagePixels, "an image is not too large");
}

bool check_container(std::string bytes) {
  return is_read([&] {
    if (nn::looks_like_png(bytes)) return require_size(nn::check_png(bytes, "image"));
    if (nn::looks_like_jpeg(bytes)) return require_size(nn::check_jpeg(bytes, "image"));
    throw Error("not an image");
  });
}

bool decode(std::string_view bytes) {
  const MemoryFile file(bytes);
  bool is_decoded = false;
  for (const auto colour : {nn::ImageColour::grey, nn::ImageColour::bgr}) {
    is_decoded = is_read([&] {
      const ByteImage image = nn::read_image(file.path(), colour);
      require(image.channels() == (colour == nn::ImageColour::grey ? 1 : 3), "as many channels as asked for");
      nn::ImageInfo size;
      size.width = image.width();
      size.height = image.height();
      require_size(size);
    });
  }
  return is_decoded;
}

}  // namespace

bool read_image_container(std::string_view bytes) {
  const bool is_whole = check_container(std::string(bytes));
  return (nn::looks_like_png(bytes) && check_container(repair_png(bytes))) || is_whole;
}

bool read_image_file(std::string_view bytes) {
  return decode(nn::looks_like_png(bytes) ? repair_png(bytes) : std::string(bytes));
}

bool read_coco_rle(std::string_view bytes) {
  bool is_decoded = false;
  for (const std::uint64_t pixels : {std::uint64_t{0}, std::uint64_t{640} * 480, std::uint64_t{1} << 40}) {
    is_decoded |= is_read([&] {
      const std::vector<std::uint32_t> runs = nn::decode_runs(bytes, pixels);
      require(std::accumulate(runs.begin(), runs.end(), std::uint64_t{0}) <= pixels, "runs lie in the image");
      require(nn::decode_runs(nn::encode_runs(runs), pixels) == runs, "runs survive being written");
    });
  }
  return is_decoded;
}

}  // namespace penumbra::fuzz
