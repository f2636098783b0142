// Messages with images, in the encodings of ROS 1 and of ROS 2, to pixels and metres.
#include "slam/sources/bag/image_pixels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "nn/base/error.h"
#include "tests/support/bag_files.h"
#include "tests/support/cv_images.h"
#include "tests/support/expect_error.h"

namespace penumbra::slam {
namespace {

using test::expect_error;
using test::ImageParts;
using test::Wire;

constexpr const char* kPlace = "run.bag: /left";

MessageEncoding encoding_of(Wire wire) {
  return wire == Wire::ros1 ? MessageEncoding::ros1 : MessageEncoding::cdr;
}

// 4 x 2 pixels of `bytes` bytes each, and rows of 3 bytes more.
ImageParts small(const std::string& encoding, std::uint32_t bytes, std::initializer_list<int> data) {
  ImageParts image;
  image.encoding = encoding;
  image.width = 4;
  image.height = 2;
  image.step = 4 * bytes + 3;
  image.stamp = 12'000'000'034;
  std::size_t i = 0;
  for (const int value : data) {
    image.data += static_cast<char>(value);
    if (++i % (4 * bytes) == 0) image.data += "???";
  }
  return image;
}

nn::StoredImage pixels(const ImageParts& parts, nn::ImageColour colour,
                       nn::ImageBits bits = nn::ImageBits::stored) {
  const std::string bytes = test::image_message(Wire::ros1, parts);
  return pixels_of(read_image_message(bytes, MessageEncoding::ros1, kPlace), colour, bits, kPlace);
}
FloatImage depth(const ImageParts& parts) {
  const std::string bytes = test::image_message(Wire::ros1, parts);
  return depth_of(read_image_message(bytes, MessageEncoding::ros1, kPlace), kPlace);
}

TEST(Messages, AreTheSameInEveryEncoding) {
  test::CameraParts camera = test::pinhole(640, 480, 500.5, -60.25);
  camera.D = {0.1, -0.2, 0.003, 0.004, 0.5};
  camera.binning_and_roi = {2, 2, 10, 20, 400, 600};
  for (const Wire wire : {Wire::ros1, Wire::cdr, Wire::cdr_big_endian, Wire::cdr2}) {
    for (const char* frame : {"", "c", "cam", "left_camera"}) {
      ImageParts parts = small("mono8", 1, {1, 2, 3, 4, 5, 6, 7, 8});
      parts.frame = camera.frame = frame;
      const std::string bytes = test::image_message(wire, parts);
      const ImageMessage image = read_image_message(bytes, encoding_of(wire), kPlace);
      EXPECT_EQ(image.header.stamp, parts.stamp);
      EXPECT_EQ(image.header.frame, frame);
      EXPECT_EQ(image.width, 4U);
      EXPECT_EQ(image.height, 2U);
      EXPECT_EQ(image.step, parts.step);
      EXPECT_EQ(image.encoding, "mono8");
      EXPECT_EQ(image.data, parts.data);
      const CameraInfoMessage info =
          read_camera_info(test::camera_message(wire, camera), encoding_of(wire), kPlace);
      EXPECT_EQ(info.frame, frame);
      EXPECT_EQ(info.model, "plumb_bob");
      EXPECT_EQ(info.D, camera.D);
      EXPECT_EQ(info.K, camera.K);
      EXPECT_EQ(info.R, camera.R);
      EXPECT_EQ(info.P, camera.P);
      EXPECT_EQ(info.binning_y, 2U);
      EXPECT_EQ(info.roi_x, 10U);
      EXPECT_EQ(info.roi_width, 600U);
      const std::string packed = test::compressed_message(wire, 5, "png", "bytes");
      EXPECT_EQ(read_compressed_image(packed, encoding_of(wire), kPlace).data, "bytes");
      // Torn anywhere, each is refused.
      for (std::size_t size = 0; size < bytes.size(); ++size) {
        EXPECT_THROW(read_image_message(bytes.substr(0, size), encoding_of(wire), kPlace), InputError);
      }
    }
  }
  expect_error<InputError>(
      [] { read_image_message(std::string("\x28\xB5\x2F\xFDxxxx", 8), MessageEncoding::cdr, kPlace); },
      {kPlace, "zstd"});
  expect_error<InputError>(
      [] { read_image_message(std::string("\0\3\0\0xxxx", 8), MessageEncoding::cdr, kPlace); },
      {"plain CDR", "0003"});
}

TEST(ImagePixels, EveryEncodingGivesItsColours) {
  const auto expect_bgr = [](const char* encoding, std::uint32_t bytes, std::initializer_list<int> data) {
    SCOPED_TRACE(encoding);
    const nn::StoredImage image = pixels(small(encoding, bytes, data), nn::ImageColour::bgr);
    ASSERT_EQ(image.channels(), 3);
    ASSERT_EQ(image.size(), (Size{4, 2}));
    EXPECT_EQ(image.bytes.at(1, 0, 0), 10);
    EXPECT_EQ(image.bytes.at(1, 0, 1), 20);
    EXPECT_EQ(image.bytes.at(1, 0, 2), 30);
    EXPECT_EQ(pixels(small(encoding, bytes, data), nn::ImageColour::grey).channels(), 1);
  };
  expect_bgr("bgr8", 3, {0, 0, 0, 10, 20, 30, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  expect_bgr("8UC3", 3, {0, 0, 0, 10, 20, 30, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  expect_bgr("rgb8", 3, {0, 0, 0, 30, 20, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  expect_bgr("bgra8", 4, {0, 0, 0, 0, 10, 20, 30, 9, 0, 0, 0, 0, 0, 0, 0, 0,
                          0, 0, 0, 0, 0,  0,  0,  0, 0, 0, 0, 0, 0, 0, 0, 0});
  expect_bgr("rgba8", 4, {0, 0, 0, 0, 30, 20, 10, 9, 0, 0, 0, 0, 0, 0, 0, 0,
                          0, 0, 0, 0, 0,  0,  0,  0, 0, 0, 0, 0, 0, 0, 0, 0});
  expect_bgr("bayer_rggb8", 1, {30, 20, 30, 20, 20, 10, 20, 10});
  expect_bgr("bayer_bggr8", 1, {10, 20, 10, 20, 20, 30, 20, 30});
  expect_bgr("bayer_gbrg8", 1, {20, 10, 20, 10, 30, 20, 30, 20});
  expect_bgr("bayer_grbg8", 1, {20, 30, 20, 30, 10, 20, 10, 20});
  const nn::StoredImage uyvy =
      pixels(small("yuv422", 2, {128, 16, 128, 235, 128, 16, 128, 16, 128, 16, 128, 16, 128, 16, 128, 16}),
             nn::ImageColour::bgr);
  EXPECT_EQ(uyvy.bytes.at(1, 0, 0), 255);
  EXPECT_EQ(uyvy.bytes.at(0, 0, 2), 0);
  const nn::StoredImage grey = pixels(small("mono8", 1, {1, 2, 3, 4, 5, 6, 7, 8}), nn::ImageColour::grey);
  EXPECT_EQ(grey.bytes.at(3, 1), 8);
}

TEST(ImagePixels, SixteenBitsComeInEitherByteOrder) {
  ImageParts parts = small("mono16", 2, {0x12, 0x34, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(pixels(parts, nn::ImageColour::grey).words.at(0, 0), 0x3412);
  parts.is_big_endian = true;
  EXPECT_EQ(pixels(parts, nn::ImageColour::grey).words.at(0, 0), 0x1234);
  EXPECT_EQ(pixels(parts, nn::ImageColour::grey, nn::ImageBits::eight).bytes.at(0, 0), 0x12);
}

TEST(ImagePixels, WhatIsNoneIsRefusedByName) {
  const auto refused = [](const ImageParts& parts, std::initializer_list<std::string> texts) {
    expect_error<InputError>([&] { pixels(parts, nn::ImageColour::grey); }, texts);
  };
  refused(small("bayer_rggb16", 2, {}), {kPlace, "mono8", "'bayer_rggb16'"});
  refused(small("mono8", 1, {1, 2, 3, 4, 5, 6}), {kPlace, "bytes of pixels"});
  ImageParts parts = small("mono8", 1, {1, 2, 3, 4, 5, 6, 7, 8});
  parts.step = 3;
  refused(parts, {"rows of at least 4 bytes", "3"});
  parts.width = 0;
  refused(parts, {kPlace, "0"});
  parts.width = 1U << 31;
  refused(parts, {kPlace});
  parts = small("yuyv", 2, {});
  parts.width = 3;
  parts.data.assign(40, 'x');
  refused(parts, {"even width", "3"});
  expect_error<InputError>(
      [] {
        depth(small("rgb8", 3, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
      },
      {"depth (16UC1", "rgb8"});
}

TEST(ImagePixels, DepthIsInMetresAndZeroWhereUnknown) {
  const FloatImage levels =
      depth(small("16UC1", 2, {0xE8, 0x03, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xD0, 0x07}));
  EXPECT_FLOAT_EQ(levels.at(0, 0), 1.0F);
  EXPECT_FLOAT_EQ(levels.at(1, 0), 0.0F);
  EXPECT_FLOAT_EQ(levels.at(3, 1), 2.0F);
  ImageParts metres;
  metres.encoding = "32FC1";
  metres.width = 4;
  metres.height = 1;
  metres.step = 16;
  for (const float value :
       {1.5F, -1.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    metres.data += test::little_endian(value);
  const FloatImage floats = depth(metres);
  EXPECT_EQ(floats.at(0, 0), 1.5F);
  for (const int x : {1, 2, 3}) EXPECT_EQ(floats.at(x, 0), 0.0F);
}

std::string encoded(const char* ending, const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  cv::imencode(ending, image, bytes);
  return {bytes.begin(), bytes.end()};
}

// Views of both.
CompressedImageMessage compressed(std::string_view format, std::string_view data) {
  CompressedImageMessage image;
  image.format = format;
  image.data = data;
  return image;
}

TEST(CompressedPixels, JpegAndPngAreDecoded) {
  const cv::Mat colour(8, 16, CV_8UC3, cv::Scalar(10, 100, 200));
  for (const char* ending : {".png", ".jpg"}) {
    const std::string bytes = encoded(ending, colour);
    const CompressedImageMessage image = compressed("rgb8; jpeg compressed bgr8", bytes);
    const nn::StoredImage pixels = pixels_of(image, nn::ImageColour::bgr, nn::ImageBits::stored, kPlace);
    EXPECT_NEAR(pixels.bytes.at(5, 5, 2), 200, 3);
    EXPECT_EQ(info_of(image, kPlace).width, 16);
  }
  // A grey PNG is grey, whatever is asked for; a mosaic of bayer filters is resolved.
  const std::string grey = encoded(".png", cv::Mat(4, 5, CV_8UC1, cv::Scalar(77)));
  EXPECT_EQ(pixels_of(compressed("mono8; png compressed", grey), nn::ImageColour::bgr, nn::ImageBits::stored,
                      kPlace)
                .bytes.at(0, 0, 1),
            77);
  cv::Mat mosaic(4, 4, CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < 4; y += 2)
    for (int x = 0; x < 4; x += 2) mosaic.at<unsigned char>(y, x) = 200;
  const std::string packed = encoded(".png", mosaic);
  const nn::StoredImage red = pixels_of(compressed("bayer_rggb8; png compressed ", packed),
                                        nn::ImageColour::bgr, nn::ImageBits::stored, kPlace);
  EXPECT_EQ(red.bytes.at(1, 1, 2), 200);
  EXPECT_EQ(red.bytes.at(1, 1, 0), 0);
  expect_error<InputError>(
      [&] {
        pixels_of(compressed("jpeg", "no image"), nn::ImageColour::grey, nn::ImageBits::stored, kPlace);
      },
      {kPlace});
}

// The transport's own quantisation (compressed_depth_image_transport): A = q (q + 1), B = 1 - A / far, levels
// A / Z + B.
TEST(CompressedPixels, CompressedDepthComesBackToTheStepOfItsQuantisation) {
  const float quantisation = 100.0F, far = 10.0F;
  const float a = quantisation * (quantisation + 1.0F), b = 1.0F - a / far;
  const std::string before =
      test::little_endian(std::uint32_t{0}) + test::little_endian(a) + test::little_endian(b);
  cv::Mat levels(1, 4, CV_16UC1);
  const float metres[] = {0.5F, 1.0F, 3.0F, 9.0F};
  for (int x = 0; x < 4; ++x) levels.at<std::uint16_t>(0, x) = static_cast<std::uint16_t>(a / metres[x] + b);
  const std::string data = before + encoded(".png", levels);
  const FloatImage depth = depth_of(compressed("32FC1; compressedDepth png", data), kPlace);
  for (int x = 0; x < 4; ++x) EXPECT_NEAR(depth.at(x, 0), metres[x], metres[x] * metres[x] / a);
  levels.at<std::uint16_t>(0, 0) = 0;
  const std::string holes = before + encoded(".png", levels);
  EXPECT_EQ(depth_of(compressed("32FC1; compressedDepth", holes), kPlace).at(0, 0), 0.0F);
  levels.at<std::uint16_t>(0, 0) = 1500;
  const std::string words = before + encoded(".png", levels);
  EXPECT_FLOAT_EQ(depth_of(compressed("16UC1; compressedDepth png", words), kPlace).at(0, 0), 1.5F);
  expect_error<InputError>([&] { depth_of(compressed("16UC1; compressedDepth rvl", words), kPlace); },
                           {kPlace, "RVL"});
  expect_error<InputError>([&] { depth_of(compressed("16UC1; compressedDepth png", "short"), kPlace); },
                           {"12 bytes"});
}

}  // namespace
}  // namespace penumbra::slam
