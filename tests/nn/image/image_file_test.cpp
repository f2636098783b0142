#include "nn/image/image_file.h"

#include <gtest/gtest.h>

#include <array>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/image/exif.h"
#include "tests/support/cv_images.h"
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
    test::write_mat(folder_ / "a.png", image);
    const cv::Mat read =
        test::read_mat(folder_ / "a.png", type == CV_8UC1 ? ImageColour::grey : ImageColour::bgr);
    ASSERT_EQ(read.type(), type);
    EXPECT_EQ(cv::norm(image, read, cv::NORM_INF), 0.0);
  }
}

TEST_F(ImageFile, GreyAndColourAreConverted) {
  test::write_mat(folder_ / "grey.png", test_picture(CV_8UC1));
  test::write_mat(folder_ / "colour.jpg", test_picture(CV_8UC3));
  EXPECT_EQ(test::read_mat(folder_ / "grey.png", ImageColour::bgr).type(), CV_8UC3);
  EXPECT_EQ(test::read_mat(folder_ / "colour.jpg", ImageColour::grey).type(), CV_8UC1);
}

TEST_F(ImageFile, SixteenBitPngIsScaledToEightBits) {
  const cv::Mat image(20, 30, CV_16UC1, cv::Scalar(0x8123));
  const cv::Mat read = test::read_mat(file("a.png", encoded(".png", image)), ImageColour::grey);
  ASSERT_EQ(read.type(), CV_8UC1);
  EXPECT_EQ(read.at<unsigned char>(3, 4), 0x81);
}

TEST_F(ImageFile, PngIsReadWithoutItsAncillaryChunks) {
  const cv::Mat image = test_picture(CV_8UC1);
  std::string bytes = encoded(".png", image);
  bytes.insert(33, png_chunk("iCCP", "a broken colour profile, of which libpng would complain"));
  const cv::Mat read = test::read_mat(file("a.png", bytes), ImageColour::grey);
  EXPECT_EQ(cv::norm(image, read, cv::NORM_INF), 0.0);
}

TEST_F(ImageFile, ProgressiveJpegAndBytesAfterItsEndAreRead) {
  const cv::Mat image = test_picture(CV_8UC3);
  const std::string bytes = encoded(".jpg", image, {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  const cv::Mat read = test::read_mat(file("a.jpg", bytes + std::string(100, '\0')), ImageColour::bgr);
  EXPECT_EQ(read.size(), image.size());
}

TEST_F(ImageFile, MissingFileFolderEmptyFileAndTextAreRefused) {
  expect_error<InputError>([&] { read_image(folder_ / "no.png", ImageColour::grey); },
                           {(folder_ / "no.png").string(), "no such file"});
  expect_error<InputError>([&] { read_image(folder_.path(), ImageColour::grey); }, {"a folder"});
  expect_error<InputError>([&] { read_image("/dev/zero", ImageColour::grey); }, {"not a plain file"});
  expect_refused("empty.png", "", {"an empty file"});
  expect_refused("text.png", "this is not an image, whatever its name says",
                 {"a PNG, JPEG, PGM or BMP", "begins with 'this is not an i'"});
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
  expect_error<Error>([&] { test::write_mat(folder_ / "no/such/folder/a.png", image); },
                      {"cannot be written"});
  expect_error<Error>([&] { test::write_mat(folder_ / "a.unknown", image); }, {"a.unknown", "cannot encode"});
  expect_error<Error>([&] { test::write_mat(folder_ / "a.png", cv::Mat()); }, {"a.png", "cannot encode"});
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

// EXIF data of one entry.
std::string exif_with_orientation(int value, bool big_endian, int type = 3) {
  const auto number = [&](int n, std::size_t size) {
    std::string text;
    for (std::size_t i = 0; i < size; ++i)
      text += static_cast<char>(n >> 8 * (big_endian ? size - 1 - i : i));
    return text;
  };
  return (big_endian ? "MM" : "II") + number(42, 2) + number(8, 4) + number(2, 2) + number(0x10F, 2) +
         number(2, 2) + number(1, 4) + number(0, 4) + number(0x112, 2) + number(type, 2) + number(1, 4) +
         (type == 3 ? number(value, 2) + number(0, 2) : number(value, 4)) + number(0, 4);
}

std::string with_exif(std::string jpeg, const std::string& exif) {
  const std::string data = std::string("Exif\0\0", 6) + exif;
  const std::size_t length = data.size() + 2;
  return jpeg.insert(
      2, "\xFF\xE1" + std::string{static_cast<char>(length >> 8), static_cast<char>(length)} + data);
}

// The picture of two rows, 0 1 2 / 3 4 5, as a camera stores it that was held in the eight ways.
TEST_F(ImageFile, EightOrientationsAreTurnedUpright) {
  const cv::Mat1b upright = (cv::Mat1b(2, 3) << 0, 1, 2, 3, 4, 5);
  const std::array<cv::Mat1b, 9> stored = {cv::Mat1b(),
                                           upright,
                                           (cv::Mat1b(2, 3) << 2, 1, 0, 5, 4, 3),
                                           (cv::Mat1b(2, 3) << 5, 4, 3, 2, 1, 0),
                                           (cv::Mat1b(2, 3) << 3, 4, 5, 0, 1, 2),
                                           (cv::Mat1b(3, 2) << 0, 3, 1, 4, 2, 5),
                                           (cv::Mat1b(3, 2) << 2, 5, 1, 4, 0, 3),
                                           (cv::Mat1b(3, 2) << 5, 2, 4, 1, 3, 0),
                                           (cv::Mat1b(3, 2) << 3, 0, 4, 1, 5, 2)};
  for (int value = 1; value <= 8; ++value) {
    for (const bool big_endian : {false, true}) {
      const std::string exif = exif_with_orientation(value, big_endian, big_endian ? 3 : 4);
      std::string bytes = encoded(".png", stored[static_cast<std::size_t>(value)]);
      bytes.insert(33, png_chunk("eXIf", exif));
      const std::filesystem::path path = file("a.png", bytes);
      EXPECT_EQ(read_image_info(path).orientation, value);
      const cv::Mat read = test::read_mat(path, ImageColour::grey, ImageOrientation::upright);
      ASSERT_EQ(read.size(), upright.size()) << value;
      EXPECT_EQ(cv::norm(read, upright, cv::NORM_INF), 0.0) << value;
      EXPECT_EQ(test::read_mat(path, ImageColour::grey).size(),
                stored[static_cast<std::size_t>(value)].size());
      // As OpenCV turns a JPEG.
      const std::string jpeg = with_exif(encoded(".jpg", test_picture(CV_8UC3)), exif);
      const std::filesystem::path photograph = file("a.jpg", jpeg);
      const cv::Mat ours = test::read_mat(photograph, ImageColour::bgr, ImageOrientation::upright);
      const cv::Mat theirs = cv::imread(photograph.string(), cv::IMREAD_COLOR);
      ASSERT_EQ(ours.size(), theirs.size()) << value;
      EXPECT_EQ(cv::norm(ours, theirs, cv::NORM_INF), 0.0) << value;
    }
  }
}

TEST_F(ImageFile, DamagedExifDataLeaveThePictureAsItIs) {
  const std::string exif = exif_with_orientation(6, true);
  for (std::size_t size = 0; size < exif.size() - 6; ++size) {
    EXPECT_EQ(exif_orientation(exif.substr(0, size)), kUpright);
  }
  EXPECT_EQ(exif_orientation(exif_with_orientation(9, true)), kUpright);
  EXPECT_EQ(exif_orientation(exif_with_orientation(0, false)), kUpright);
  EXPECT_EQ(exif_orientation(exif_with_orientation(6, false, 2)), kUpright);
}

TEST_F(ImageFile, SixteenBitImagesAreReadWithAllTheirBits) {
  cv::Mat1w image(20, 30, std::uint16_t{0x0123});
  image(4, 5) = 0x03FF;
  std::string bytes = encoded(".png", image);
  const std::filesystem::path plain = file("a.png", bytes);
  EXPECT_EQ(read_image_info(plain).bit_depth, 16);
  EXPECT_EQ(read_image_info(plain).significant_bits, 16);
  const cv::Mat read = test::to_mat(read_stored_image(plain, ImageColour::grey));
  ASSERT_EQ(read.type(), CV_16UC1);
  EXPECT_EQ(cv::norm(read, image, cv::NORM_INF), 0.0);
  EXPECT_EQ(test::to_mat(read_stored_image(plain, ImageColour::bgr)).type(), CV_16UC3);
  bytes.insert(33, png_chunk("sBIT", "\x0A"));
  EXPECT_EQ(read_image_info(file("b.png", bytes)).significant_bits, 10);
  EXPECT_EQ(read_stored_image(folder_ / "b.png", ImageColour::grey).words.at(5, 4), 0x03FF);
}

TEST_F(ImageFile, NetpbmImagesAreRead) {
  const cv::Mat image = test_picture(CV_8UC1), colour = test_picture(CV_8UC3);
  for (const int binary : {0, 1}) {
    const std::vector<int> settings = {cv::IMWRITE_PXM_BINARY, binary};
    const cv::Mat grey = test::read_mat(file("a.PGM", encoded(".pgm", image, settings)), ImageColour::grey);
    EXPECT_EQ(cv::norm(grey, image, cv::NORM_INF), 0.0) << binary;
    const cv::Mat bgr = test::read_mat(file("a.ppm", encoded(".ppm", colour, settings)), ImageColour::bgr);
    EXPECT_EQ(cv::norm(bgr, colour, cv::NORM_INF), 0.0) << binary;
  }
  const cv::Mat text =
      test::read_mat(file("t.pgm", "P2 # of a tool\n3 # wide\n1\n100\n0 50\n100 "), ImageColour::bgr);
  ASSERT_EQ(text.type(), CV_8UC3);
  EXPECT_EQ(text.at<cv::Vec3b>(0, 1), cv::Vec3b(128, 128, 128));
  const std::filesystem::path wide = file("w.pgm", std::string("P5 2 1 1023\n\x03\xFF\x01\x23", 16));
  EXPECT_EQ(read_stored_image(wide, ImageColour::grey).words.at(1, 0), 0x123);
  EXPECT_EQ(read_image(wide, ImageColour::grey).at(0, 0), 255);
  EXPECT_EQ(read_image(wide, ImageColour::grey).at(1, 0), 0x123 >> 2);
  EXPECT_EQ(read_image_info(wide).significant_bits, 10);
  EXPECT_EQ(read_depth_image(wide).at(0, 0), 1023);
}

TEST_F(ImageFile, NetpbmImagesThatAreTornOrInconsistentAreRefused) {
  const std::string bytes = encoded(".pgm", test_picture(CV_8UC1));
  for (std::size_t size = 3; size < bytes.size(); size += size < 20 ? 1 : 97) {
    expect_refused("torn.pgm", bytes.substr(0, size), {"torn.pgm"});
  }
  expect_refused("long.pgm", bytes + "more", {"the end of the image", "4 more bytes"});
  expect_refused("high.pgm", "P2 2 1 7 3 8", {"values up to 7", "8"});
  expect_refused("minus.pgm", "P2 2 -1 7 3 8", {"a height as a whole number", "'-1 7 3 8'"});
  expect_refused("none.pgm", "P2 2 0 7 3 8", {"2 x 0"});
  expect_refused("deep.pgm", "P5 2 2 65536 aaaaaaaa", {"1..65535", "65536"});
  expect_refused("huge.pgm", "P5 9999999999 9999999999 255 a", {"claims"});
}

TEST_F(ImageFile, BmpImagesAreRead) {
  const cv::Mat image = test_picture(CV_8UC1), colour = test_picture(CV_8UC3);
  const cv::Mat grey = test::read_mat(file("a.BMP", encoded(".bmp", image)), ImageColour::grey);
  EXPECT_EQ(cv::norm(grey, image, cv::NORM_INF), 0.0);
  std::string bytes = encoded(".bmp", colour);
  const cv::Mat bgr = test::read_mat(file("a.bmp", bytes), ImageColour::bgr);
  EXPECT_EQ(cv::norm(bgr, colour, cv::NORM_INF), 0.0);
  const int top_down = -colour.rows;
  bytes.replace(22, 4, std::string(reinterpret_cast<const char*>(&top_down), 4));
  cv::Mat flipped;
  cv::flip(colour, flipped, 0);
  EXPECT_EQ(cv::norm(test::read_mat(file("b.bmp", bytes), ImageColour::bgr), flipped, cv::NORM_INF), 0.0);
  for (std::size_t size = 18; size < bytes.size(); size += size < 60 ? 1 : 97) {
    expect_refused("torn.bmp", bytes.substr(0, size), {"torn"});
  }
  expect_refused("rle.bmp", std::string(bytes).replace(30, 1, "\x01"), {"without compression"});
}

TEST_F(ImageFile, OtherFormatsAreNamedWithWhatConvertsThem) {
  expect_refused("a.tif", std::string("II*\0\x08\0\0\0", 8), {"a TIFF image", "convert '", "a.png'"});
  expect_refused("a.jpg", std::string("RIFF\x08\0\0\0WEBPVP8 ", 16), {"a WebP image", "convert"});
  expect_refused("a.heic",
                 std::string("\0\0\0\x18"
                             "ftypheic",
                             12),
                 {"a HEIC image", "heif-convert"});
  expect_refused("a.gif", "GIF89a", {"a GIF image"});
  expect_refused("a.jp2", std::string("\0\0\0\x0CjP  ", 8), {"a JPEG 2000 image"});
  expect_refused("a.mp4",
                 std::string("\0\0\0\x18"
                             "ftypisom",
                             12),
                 {"a video", "ffmpeg"});
  expect_refused("a.png", "version https://git-lfs.github.com/spec/v1", {"git-lfs", "git lfs pull"});
}

TEST(ImageFileRealData, KittiImagesAreRead) {
  PENUMBRA_REAL_DATA(path, "kitti/sequences/00/image_0/000000.png");
  const cv::Mat ours = test::read_mat(path, ImageColour::grey);
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
