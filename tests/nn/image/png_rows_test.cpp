#include "nn/image/png_rows.h"

#include <gtest/gtest.h>
#include <png.h>

#include <opencv2/imgcodecs.hpp>
#include <random>

#include "nn/base/error.h"
#include "nn/image/image_container.h"
#include "nn/image/png_codec.h"
#include "tests/support/cv_images.h"

namespace penumbra::nn {
namespace {

cv::Mat some_picture(std::mt19937& random, int type) {
  cv::Mat image(static_cast<int>(1 + random() % 40), static_cast<int>(1 + random() % 60), type);
  const unsigned steps = 1 + random() % 60;
  unsigned value = random();
  for (auto byte = image.datastart; byte != image.dataend; ++byte) {
    value += random() % steps;
    *const_cast<unsigned char*>(byte) = static_cast<unsigned char>(value);
  }
  return image;
}

// A PNG by libpng: each row with the one of the given filters that libpng takes, packed at `level`.
std::string encoded(const cv::Mat& image, int filters, int level, bool interlaced = false) {
  std::string out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep bytes, std::size_t size) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<const char*>(bytes), size);
      },
      nullptr);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, filters);
  png_set_compression_level(png, level);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.cols), static_cast<png_uint_32>(image.rows),
               image.depth() == CV_16U ? 16 : 8,
               image.channels() == 3 ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  if (image.channels() == 3) png_set_bgr(png);
  if (image.depth() == CV_16U) png_set_swap(png);
  std::vector<png_bytep> rows;
  for (int y = 0; y < image.rows; ++y) rows.push_back(const_cast<png_bytep>(image.ptr(y)));
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

bool decode(std::string bytes, ImageColour colour, bool eight_bits, StoredImage& image) {
  image = {};
  image.info = check_png(bytes, "test");
  return decode_plain_png(bytes, colour, eight_bits, image);
}

TEST(PngRows, AreThoseThatWereWritten) {
  std::mt19937 random(1);
  for (int i = 0; i < 400; ++i) {
    for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1}) {
      const cv::Mat picture = some_picture(random, type);
      const int filters[] = {PNG_FILTER_NONE, PNG_FILTER_SUB,   PNG_FILTER_UP,
                             PNG_FILTER_AVG,  PNG_FILTER_PAETH, PNG_ALL_FILTERS};
      const std::string bytes = encoded(picture, filters[i % 6], static_cast<int>(random() % 10));
      StoredImage image;
      ASSERT_TRUE(decode(bytes, ImageColour::stored, false, image)) << i << " " << type;
      ASSERT_EQ(cv::norm(test::to_mat(image), picture, cv::NORM_INF), 0.0) << i << " " << type;
      const std::vector<char> buffer(bytes.begin(), bytes.end());
      ASSERT_EQ(cv::norm(cv::imdecode(buffer, cv::IMREAD_UNCHANGED), picture, cv::NORM_INF), 0.0)
          << "the oracle";
    }
  }
}

TEST(PngRows, LeavesOtherKindsToLibpng) {
  std::mt19937 random(2);
  StoredImage image;
  const std::string grey = encoded(some_picture(random, CV_8UC1), PNG_FILTER_SUB, 1);
  const std::string colour = encoded(some_picture(random, CV_8UC3), PNG_FILTER_SUB, 1);
  const std::string wide = encoded(some_picture(random, CV_16UC1), PNG_FILTER_SUB, 1);
  EXPECT_TRUE(decode(grey, ImageColour::grey, true, image));
  EXPECT_FALSE(decode(grey, ImageColour::bgr, true, image));
  EXPECT_TRUE(decode(colour, ImageColour::bgr, true, image));
  EXPECT_FALSE(decode(colour, ImageColour::grey, true, image));
  EXPECT_TRUE(decode(wide, ImageColour::grey, false, image));
  EXPECT_FALSE(decode(wide, ImageColour::grey, true, image));
  EXPECT_FALSE(decode(encoded(some_picture(random, CV_8UC1), PNG_FILTER_SUB, 1, true), ImageColour::grey,
                      true, image));
  const cv::Mat with_alpha(20, 30, CV_8UC4, cv::Scalar(1, 2, 3, 4));
  std::vector<unsigned char> bytes;
  cv::imencode(".png", with_alpha, bytes);
  EXPECT_FALSE(decode({bytes.begin(), bytes.end()}, ImageColour::stored, true, image));
}

// Below checksums that are right: what is packed wrongly is left to libpng, which refuses it, or has the rows
// before it finds something wrong.
TEST(PngRows, LeavesDamagedOnesToLibpng) {
  std::mt19937 random(3);
  const auto crc = [](const std::string& text) {
    std::uint32_t sum = 0xFFFFFFFFU;
    for (const char byte : text) {
      sum ^= static_cast<unsigned char>(byte);
      for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ ((sum & 1U) != 0 ? 0xEDB88320U : 0U);
    }
    return ~sum;
  };
  for (int i = 0; i < 300; ++i) {
    const cv::Mat picture = some_picture(random, CV_8UC1);
    std::string bytes = encoded(picture, PNG_ALL_FILTERS, 6);
    const std::size_t at = bytes.find("IDAT"), end = bytes.find("IEND") - 8;
    const std::size_t flipped = at + 4 + random() % (end - at - 4);
    bytes[flipped] = static_cast<char>(bytes[flipped] ^ (1 << random() % 8));
    const std::uint32_t sum = crc(bytes.substr(at, end - at));
    for (std::size_t k = 0; k < 4; ++k) bytes[end + k] = static_cast<char>(sum >> (24 - 8 * k));
    StoredImage image;
    if (decode(bytes, ImageColour::grey, true, image)) {
      // A bit that says nothing, such as one behind the last code: the checksum holds, and so do the pixels.
      ASSERT_EQ(cv::norm(test::to_mat(image), picture, cv::NORM_INF), 0.0) << i;
      continue;
    }
    const ImageInfo info = check_png(bytes, "test");
    try {
      const StoredImage read = decode_png(bytes, info, ImageColour::grey, true, "test");
      EXPECT_EQ(read.bytes.size(), (Size{info.width, info.height})) << i;
    } catch (const InputError&) {
    }
  }
}

}  // namespace
}  // namespace penumbra::nn
