#include "nn/image/netpbm.h"

#include <bit>
#include <cctype>
#include <cstdint>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::nn {

namespace {

constexpr std::uint32_t kLargestNumber = 1U << 28;  // of a header; larger ones are not read to their end

bool is_space(char byte) { return std::isspace(static_cast<unsigned char>(byte)) != 0; }

class NetpbmReader {
 public:
  NetpbmReader(std::string_view bytes, std::string_view place) : bytes_(bytes), place_(place) {}

  StoredImage read() {
    const char kind = bytes_[1];
    const bool is_text = kind == '2' || kind == '3';
    const int channels = kind == '3' || kind == '6' ? 3 : 1;
    const std::uint32_t width = number("a width"), height = number("a height");
    largest_ = number("the largest value");
    if (largest_ < 1 || largest_ > 65535) {
      throw InputError(place_, "a largest value of 1..65535", fmt::format("{}", largest_));
    }
    StoredImage image;
    image.info = checked_image_size(width, height, place_);
    const bool is_wide = largest_ > 255;
    image.info.bit_depth = is_wide ? 16 : 8;
    image.info.significant_bits = is_wide ? std::bit_width(largest_) : 8;
    // Before memory is taken: every value costs the file at least so many bytes.
    const std::uint64_t values = std::uint64_t{width} * height * static_cast<std::uint64_t>(channels);
    const std::uint64_t needed = values * (!is_text && is_wide ? 2 : 1);
    if (!is_text) ++position_;  // the one space
    if (position_ > bytes_.size() || bytes_.size() - position_ < needed) throw_torn();

    if (is_wide) {
      image.words.create(image.info.width, image.info.height, channels);
    } else {
      image.bytes.create(image.info.width, image.info.height, channels);
    }
    for (int y = 0; y < image.info.height; ++y) {
      for (int x = 0; x < image.info.width; ++x) {
        for (int c = 0; c < channels; ++c) {
          const std::uint32_t value = is_text ? number("a value") : stored_value(is_wide);
          if (value > largest_) {
            throw InputError(place_, fmt::format("values up to {}", largest_), fmt::format("{}", value));
          }
          const int column = x * channels + (channels - 1 - c);  // red comes first, here it is last
          if (is_wide) {
            image.words.row(y)[column] = static_cast<std::uint16_t>(value);
          } else {
            image.bytes.row(y)[column] = static_cast<std::uint8_t>((value * 255 + largest_ / 2) / largest_);
          }
        }
      }
    }
    check_end();
    return image;
  }

 private:
  std::uint32_t stored_value(bool is_wide) {
    std::uint32_t value = static_cast<std::uint8_t>(bytes_[position_++]);
    if (is_wide) value = value << 8 | static_cast<std::uint8_t>(bytes_[position_++]);
    return value;
  }

  std::uint32_t number(std::string_view what) {
    while (position_ < bytes_.size() && (is_space(bytes_[position_]) || bytes_[position_] == '#')) {
      if (bytes_[position_] == '#') {
        position_ = std::min(bytes_.find_first_of("\r\n", position_), bytes_.size());
      } else {
        ++position_;
      }
    }
    if (position_ >= bytes_.size()) throw_torn();
    const std::size_t begin = position_;
    std::uint32_t value = 0;
    for (; position_ < bytes_.size() && bytes_[position_] >= '0' && bytes_[position_] <= '9'; ++position_) {
      value = std::min(value * 10 + static_cast<std::uint32_t>(bytes_[position_] - '0'), kLargestNumber);
    }
    if (begin == position_) {
      throw InputError(fmt::format("{}, byte {}", place_, begin), fmt::format("{} as a whole number", what),
                       "'" + printable(bytes_.substr(begin, 8)) + "'");
    }
    return value;
  }

  void check_end() const {
    for (std::size_t i = position_; i < bytes_.size(); ++i) {
      if (is_space(bytes_[i])) continue;
      throw InputError(fmt::format("{}, byte {}", place_, i), "the end of the image",
                       counted(bytes_.size() - i, "more byte"));
    }
  }

  [[noreturn]] void throw_torn() const {
    throw InputError(place_, "a complete PGM or PPM image",
                     fmt::format("a torn file that ends after {} bytes", bytes_.size()));
  }

  std::string_view bytes_, place_;
  std::size_t position_ = 2;  // after "P5"
  std::uint32_t largest_ = 0;
};

}  // namespace

bool looks_like_netpbm(std::string_view bytes) {
  constexpr std::string_view kKinds = "2356";
  return bytes.size() > 2 && bytes[0] == 'P' && kKinds.find(bytes[1]) != std::string_view::npos &&
         (is_space(bytes[2]) || bytes[2] == '#');
}

StoredImage read_netpbm(std::string_view bytes, std::string_view place) {
  return NetpbmReader(bytes, place).read();
}

}  // namespace penumbra::nn
