#include "nn/io/image_file.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>

#include "nn/base/error.h"
#include "nn/io/file.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::nn {
namespace {

using test::expect_error;

// A picture with structure at every scale, so that no encoder makes it tiny.
cv::Mat test_picture(int type) {
  cv::Mat image(61, 83, type);
  std::mt19937 random(7);
  for (auto byte = image.datastart; byte != image.dataend; ++byte) {
    *const_cast<unsigned char*>(byte) = static_cast<unsigned char>(random());
  }
  cv::GaussianBlur(image, image, cv::Size(5, 5), 0.0);
  return image;
}

std::string encoded(const std::string& ending, const cv::Mat& image, const std::vector<int>& settings = {}) {
  std::vector<unsigned char> bytes;
  cv::imencode(ending, image, bytes, settings);
  return {bytes.begin(), bytes.end()};
}

std::string big_endian(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
          static_cast<char>(value)};
}

// A PNG chunk with its checksum, bit by bit.
std::string png_chunk(const std::string& type, const std::string& data) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : type + data) {
    crc ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(~crc);
}

// A PNG that has a header of 8-bit grey, and nothing else.
std::string png_without_pixels(std::uint32_t width, std::uint32_t height) {
  return std::string("\x89PNG\r\n\x1a\n") +
         png_chunk("IHDR", big_endian(width) + big_endian(height) + std::string("\x08\0\0\0\0", 5)) +
         png_chunk("IEND", "");
}

// What the decoders and OpenCV print must not reach the user: our exception says it all.
class ImageFile : public testing::Test {
 protected:
  void SetUp() override { testing::internal::CaptureStderr(); }
  void TearDown() override { EXPECT_EQ(testing::internal::GetCapturedStderr(), ""); }

  std::filesystem::path file(const std::string& name, const std::string& bytes) const {
    write_file(folder_ / name, bytes);
    return folder_ / name;
  }
  void expect_refused(const std::string& name, const std::string& bytes,
                      std::initializer_list<std::string> parts) const {
    const std::filesystem::path path = file(name, bytes);
    expect_error<InputError>([&] { read_image(path, ImageColour::grey); }, {path.string()});
    expect_error<InputError>([&] { read_image(path, ImageColour::bgr); }, parts);
  }

  test::TemporaryDirectory folder_;
};

TEST_F(ImageFile, WhatIsWrittenAsPngIsReadBack) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const cv::Mat image = test_picture(type);
    write_image(folder_ / "a.png", image);
    const cv::Mat read =
        read_image(folder_ / "a.png", type == CV_8UC1 ? ImageColour::grey : ImageColour::bgr);
    ASSERT_EQ(read.type(), type);
    EXPECT_EQ(cv::norm(image, read, cv::NORM_INF), 0.0);
  }
}

TEST_F(ImageFile, GreyAndColourAreConverted) {
  write_image(folder_ / "grey.png", test_picture(CV_8UC1));
  write_image(folder_ / "colour.jpg", test_picture(CV_8UC3));
  EXPECT_EQ(read_image(folder_ / "grey.png", ImageColour::bgr).type(), CV_8UC3);
  EXPECT_EQ(read_image(folder_ / "colour.jpg", ImageColour::grey).type(), CV_8UC1);
}

TEST_F(ImageFile, SixteenBitPngIsScaledToEightBits) {
  const cv::Mat image(20, 30, CV_16UC1, cv::Scalar(0x8123));
  const cv::Mat read = read_image(file("a.png", encoded(".png", image)), ImageColour::grey);
  ASSERT_EQ(read.type(), CV_8UC1);
  EXPECT_EQ(read.at<unsigned char>(3, 4), 0x81);
}

TEST_F(ImageFile, PngIsReadWithoutItsAncillaryChunks) {
  const cv::Mat image = test_picture(CV_8UC1);
  std::string bytes = encoded(".png", image);
  bytes.insert(33, png_chunk("iCCP", "a broken colour profile, of which libpng would complain"));
  const cv::Mat read = read_image(file("a.png", bytes), ImageColour::grey);
  EXPECT_EQ(cv::norm(image, read, cv::NORM_INF), 0.0);
}

TEST_F(ImageFile, ProgressiveJpegAndBytesAfterItsEndAreRead) {
  const cv::Mat image = test_picture(CV_8UC3);
  const std::string bytes = encoded(".jpg", image, {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  const cv::Mat read = read_image(file("a.jpg", bytes + std::string(100, '\0')), ImageColour::bgr);
  EXPECT_EQ(read.size(), image.size());
}

TEST_F(ImageFile, MissingFileFolderEmptyFileAndTextAreRefused) {
  expect_error<InputError>([&] { read_image(folder_ / "no.png", ImageColour::grey); },
                           {(folder_ / "no.png").string(), "no such file"});
  expect_error<InputError>([&] { read_image(folder_.path(), ImageColour::grey); }, {"a folder"});
  expect_error<InputError>([&] { read_image("/dev/zero", ImageColour::grey); }, {"not a plain file"});
  expect_refused("empty.png", "", {"an empty file"});
  expect_refused("text.png", "this is not an image, whatever its name says", {"PNG or JPEG", "neither"});
}

TEST_F(ImageFile, PngTornAnywhereIsRefused) {
  const std::string bytes = encoded(".png", test_picture(CV_8UC1));
  for (std::size_t size = 8; size < bytes.size(); size += size < 60 ? 1 : 97) {
    expect_refused("torn.png", bytes.substr(0, size), {"complete PNG", fmt::format("{} bytes", size)});
  }
  expect_refused("torn.png", bytes.substr(0, bytes.size() - 1), {"complete PNG"});
}

TEST_F(ImageFile, JpegTornAnywhereIsRefused) {
  for (const int progressive : {0, 1}) {
    const std::string bytes =
        encoded(".jpg", test_picture(CV_8UC3), {cv::IMWRITE_JPEG_PROGRESSIVE, progressive});
    for (std::size_t size = 3; size < bytes.size(); size += size < 60 ? 1 : 97) {
      expect_refused("torn.jpg", bytes.substr(0, size), {"complete JPEG", fmt::format("{} bytes", size)});
    }
    expect_refused("torn.jpg", bytes.substr(0, bytes.size() - 1), {"complete JPEG"});
  }
}

TEST_F(ImageFile, EveryFlippedBitOfAPngIsFound) {
  const std::string bytes = encoded(".png", test_picture(CV_8UC1));
  for (std::size_t i = 0; i < bytes.size(); i += 13) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    expect_refused("damaged.png", damaged, {"damaged.png"});
  }
}

TEST_F(ImageFile, HeaderThatClaimsAHugeImageIsRefused) {
  // 65500 x 65500 pixels, without a single row.
  std::string jpeg = encoded(".jpg", test_picture(CV_8UC1));
  const std::size_t frame = jpeg.find("\xFF\xC0");
  ASSERT_NE(frame, std::string::npos);
  jpeg.replace(frame + 5, 4, "\xFF\xDC\xFF\xDC");
  expect_refused("huge.jpg", jpeg, {"claims 65500 x 65500"});

  expect_refused("huge.png", png_without_pixels(0x7FFFFFFF, 1), {"claims 2147483647 x 1"});
  expect_refused("none.png", png_without_pixels(0, 5), {"claims 0 x 5"});
  expect_refused("bomb.png", png_without_pixels(8000, 8000), {"8000 x 8000", "0 compressed bytes"});
}

TEST_F(ImageFile, RandomBytesAfterASignatureNeverCrash) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 300; ++trial) {
    std::string bytes = trial % 2 == 0 ? std::string("\x89PNG\r\n\x1a\n", 8) : std::string("\xFF\xD8\xFF", 3);
    for (int i = 0; i < 200; ++i) bytes += static_cast<char>(random());
    expect_refused("random", bytes, {"random"});
  }
}

TEST_F(ImageFile, ImageThatCannotBeWrittenIsAnError) {
  const cv::Mat image = test_picture(CV_8UC1);
  expect_error<Error>([&] { write_image(folder_ / "no/such/folder/a.png", image); }, {"cannot be written"});
  expect_error<Error>([&] { write_image(folder_ / "a.unknown", image); }, {"a.unknown", "cannot encode"});
  expect_error<Error>([&] { write_image(folder_ / "a.png", cv::Mat()); }, {"a.png", "cannot encode"});
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST(ImageFileRealData, KittiImagesAreRead) {
  PENUMBRA_REAL_DATA(path, "kitti/sequences/00/image_0/000000.png");
  const cv::Mat ours = read_image(path, ImageColour::grey);
  EXPECT_EQ(cv::norm(ours, cv::imread(path.string(), cv::IMREAD_GRAYSCALE), cv::NORM_INF), 0.0);
}

TEST(ImageFileRealData, AllCocoImagesAreRead) {
  PENUMBRA_REAL_DATA(folder, "coco/images");
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    EXPECT_FALSE(read_image(entry.path(), ImageColour::bgr).empty()) << entry.path();
  }
}

}  // namespace
}  // namespace penumbra::nn
