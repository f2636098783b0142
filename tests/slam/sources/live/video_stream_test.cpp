#include "slam/sources/live/video_stream.h"

#include <gtest/gtest.h>
#include <time.h>

#include <atomic>

#include "nn/base/error.h"
#include "nn/image/image_file.h"
#include "tests/support/bytes.h"
#include "tests/support/expect_error.h"
#include "tests/support/fake_video.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

using test::FakeCamera;
using test::FakeVideo;

struct Pair {
  ByteImage left, right;
};

Pair next_pair(VideoStream& stream, bool colour = false) {
  StreamFrame frame;
  EXPECT_TRUE(stream.read(frame));
  Pair pair;
  WordImage depth;
  stream.images(frame, colour, pair.left, pair.right, depth);
  return pair;
}

std::string counting(std::size_t bytes) {
  std::string text(bytes, '\0');
  for (std::size_t i = 0; i < bytes; ++i) text[i] = static_cast<char>(i);
  return text;
}

TEST(VideoStream, TakesTheHalvesOfGreyFramesWithPaddedLines) {
  FakeVideo video;
  FakeCamera& camera = video.add("/dev/video0");
  camera.formats = {{V4L2_PIX_FMT_YUYV, 8, 2}, {V4L2_PIX_FMT_GREY, 8, 2, 3}};
  camera.frames = {{1.0, counting(22)}, {1.033, counting(19)}};  // the last line of the second is not padded
  VideoStream stream({.left = "/dev/video0", .size = {4, 2}}, video);
  EXPECT_EQ(camera.chosen.code, V4L2_PIX_FMT_GREY);
  EXPECT_EQ(stream.size(), (Size{4, 2}));
  EXPECT_EQ(stream.description(), "/dev/video0: 8x2 GREY, 30 Hz");
  StreamFrame frame;
  ASSERT_TRUE(stream.read(frame));
  const double first = frame.timestamp;
  ByteImage left, right;
  WordImage depth;
  stream.images(frame, false, left, right, depth);
  EXPECT_EQ(left.at(3, 0), 3);
  EXPECT_EQ(right.at(0, 0), 4);
  EXPECT_EQ(right.at(3, 1), 11 + 7);
  ASSERT_TRUE(stream.read(frame));
  EXPECT_EQ(frame.index, 1);
  EXPECT_NEAR(frame.timestamp - first, 0.033, 1e-6);
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const double offset = first - 1.0 + static_cast<double>(now.tv_sec);  // the monotonic clock's since 1970
  EXPECT_NEAR(offset, static_cast<double>(::time(nullptr)), 5.0);
}

// Grey has U = V = 128; red of video range Y 81, U 90, V 240.
TEST(VideoStream, MakesGreyAndColourOfBothOrders) {
  for (const std::uint32_t code : {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_UYVY}) {
    FakeVideo video;
    FakeCamera& camera = video.add("/dev/video0");
    camera.formats = {{code, 4, 2}};
    const std::string red = code == V4L2_PIX_FMT_YUYV ? "\x51\x5a\x51\xf0" : "\x5a\x51\xf0\x51";
    camera.frames = {{1.0, red + red + red + red}, {1.1, red + red + red + red}};
    VideoStream stream({.left = "/dev/video0", .layout = StereoLayout::top_bottom, .size = {4, 1}}, video);
    const Pair grey = next_pair(stream);
    EXPECT_EQ(grey.right.channels(), 1);
    EXPECT_EQ(grey.right.at(3, 0), 0x51);
    const Pair colour = next_pair(stream, true);
    EXPECT_EQ(colour.left.channels(), 3);
    EXPECT_NEAR(colour.right.at(1, 0, 2), 255, 2);
    EXPECT_NEAR(colour.right.at(1, 0, 0), 0, 2);
  }
}

// Red of full range: Y 76, U 85, V 255. What the driver leaves to the default is full of JPEG's colours
// alone.
TEST(VideoStream, TakesTheRangeThatTheDriverMeans) {
  struct Case {
    std::uint32_t quantization, colorspace;
    bool is_full;
  };
  for (const Case& c : {Case{V4L2_QUANTIZATION_FULL_RANGE, V4L2_COLORSPACE_SRGB, true},
                        Case{V4L2_QUANTIZATION_DEFAULT, V4L2_COLORSPACE_JPEG, true},
                        Case{V4L2_QUANTIZATION_DEFAULT, V4L2_COLORSPACE_SRGB, false},
                        Case{V4L2_QUANTIZATION_DEFAULT, V4L2_COLORSPACE_REC709, false},
                        Case{V4L2_QUANTIZATION_LIM_RANGE, V4L2_COLORSPACE_JPEG, false}}) {
    FakeVideo video;
    FakeCamera& camera = video.add("/dev/video0");
    camera.formats = {{V4L2_PIX_FMT_YUYV, 4, 1}};
    camera.quantization = c.quantization;
    camera.colorspace = c.colorspace;
    const std::string red = c.is_full ? "\x4c\x55\x4c\xff" : "\x51\x5a\x51\xf0";
    camera.frames = {{1.0, red + red}};
    VideoStream stream({.left = "/dev/video0", .size = {2, 1}}, video);
    const Pair colour = next_pair(stream, true);
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(colour.left.at(1, 0, channel), channel == 2 ? 255 : 0, 2)
          << c.quantization << ' ' << c.colorspace << ' ' << channel;
  }
}

// The JPEG's Huffman tables are left out, as USB cameras do: they are those of the standard.
std::string without_tables(const std::string& jpeg) {
  std::string bytes = jpeg;
  for (std::size_t at = 2; at + 4 < bytes.size() && bytes[at + 1] != '\xDA';) {
    const std::size_t length =
        2 + 256 * static_cast<unsigned char>(bytes[at + 2]) + static_cast<unsigned char>(bytes[at + 3]);
    if (bytes[at + 1] == '\xC4') {
      bytes.erase(at, length);
    } else {
      at += length;
    }
  }
  return bytes;
}

TEST(VideoStream, TakesJpegsWhereTheyAreFaster) {
  const test::TemporaryDirectory folder;
  ByteImage image(32, 16);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 32; ++x) image.at(x, y) = static_cast<std::uint8_t>(x < 16 ? 60 : 200);
  }
  nn::write_image(folder / "frame.jpg", image);
  const std::string jpeg = test::read_file(folder / "frame.jpg");
  ASSERT_LT(without_tables(jpeg).size(), jpeg.size());
  FakeVideo video;
  FakeCamera& camera = video.add("/dev/video0");
  camera.formats = {{V4L2_PIX_FMT_YUYV, 32, 16, 0, 5}, {V4L2_PIX_FMT_MJPEG, 32, 16, 0, 30}};
  camera.frames = {{1.0, jpeg}, {1.1, without_tables(jpeg)}};
  VideoStream stream({.left = "/dev/video0", .size = {16, 16}, .rate = 30.0}, video);
  EXPECT_EQ(camera.chosen.code, V4L2_PIX_FMT_MJPEG);
  for (int i = 0; i < 2; ++i) {
    const Pair pair = next_pair(stream);
    EXPECT_NEAR(pair.left.at(8, 8), 60, 3);
    EXPECT_NEAR(pair.right.at(8, 8), 200, 3);
  }
}

TEST(VideoStream, PairsTwoCamerasByTheirTimes) {
  FakeVideo video;
  FakeCamera& left = video.add("/dev/video0");
  FakeCamera& right = video.add("/dev/video2");
  left.formats = right.formats = {{V4L2_PIX_FMT_GREY, 2, 1}};
  left.frames = {{1.000, "ab"}, {1.033, "cd"}, {1.100, "gh"}};
  right.frames = {{1.040, "CD"}, {1.070, "EF"}, {1.104, "GH"}};
  VideoStream stream({.left = "/dev/video0", .right = "/dev/video2", .size = {2, 1}}, video);
  EXPECT_EQ(stream.size(), (Size{2, 1}));
  const Pair first = next_pair(stream);
  EXPECT_EQ(first.left.at(0, 0), 'c');
  EXPECT_EQ(first.right.at(1, 0), 'D');
  const Pair second = next_pair(stream);
  EXPECT_EQ(second.left.at(0, 0), 'g');
  EXPECT_EQ(second.right.at(0, 0), 'G');
  EXPECT_EQ(stream.remark(),
            "images of a pair were 5.5 ms apart at the mean, 7.0 ms at most, 2 had no partner");
}

TEST(VideoStream, LeavesOutDamagedFramesAndWaitsForACameraThatIsGone) {
  FakeVideo video;
  FakeCamera& camera = video.add("/dev/video0");
  camera.formats = {{V4L2_PIX_FMT_GREY, 4, 1}};
  camera.frames = {{1.0, "abcd", true}, {1.1, "abc"}, {1.2, "efgh"}};
  {
    VideoStream stream({.left = "/dev/video0", .size = {2, 1}}, video);
    EXPECT_EQ(next_pair(stream).left.at(0, 0), 'e');
    EXPECT_EQ(stream.remark(), "damaged: 2 frames of /dev/video0");
    VideoDevice device("/dev/video0", {.size = {4, 1}}, video);
    camera.is_there = false;
    VideoFrame frame;
    EXPECT_FALSE(device.take(1, frame));  // unplugged
    EXPECT_EQ(device.lost(), 1);
    EXPECT_FALSE(device.take(1, frame));  // and not yet there
    camera.is_there = true;
    camera.frames = {{7.0, "ijkl"}};
    for (int i = 0; i < 200 && frame.bytes.empty(); ++i) device.take(5, frame);
    EXPECT_EQ(std::string(frame.bytes.begin(), frame.bytes.end()), "ijkl");
    EXPECT_EQ(camera.opened, 3);
  }
  EXPECT_FALSE(camera.streams);
  EXPECT_EQ(video.mapped(), 0);
  EXPECT_EQ(video.open_devices(), 0);
}

TEST(VideoStream, EndsWhereItIsStopped) {
  FakeVideo video;
  video.add("/dev/video0").formats = {{V4L2_PIX_FMT_GREY, 4, 1}};
  VideoStream stream({.left = "/dev/video0"}, video);  // as the camera stands
  EXPECT_EQ(stream.size(), (Size{2, 1}));
  stream.stop();
  StreamFrame frame;
  EXPECT_FALSE(stream.read(frame));
}

TEST(VideoStream, NamesDeviceAndWhatItOffers) {
  FakeVideo video;
  FakeCamera& camera = video.add("/dev/video0");
  camera.formats = {
      {V4L2_PIX_FMT_YUYV, 640, 480}, {V4L2_PIX_FMT_YUYV, 1280, 720}, {V4L2_PIX_FMT_H264, 640, 480}};
  const auto refused = [&](const VideoStreamOptions& options, std::initializer_list<std::string> parts) {
    test::expect_error<Error>([&] { VideoStream(options, video); }, parts);
    EXPECT_EQ(video.open_devices(), 0);
  };
  refused({.left = "/dev/video0", .size = {672, 376}},
          {"/dev/video0", "expected images of 1344x376 pixels as GREY, YUYV, UYVY or MJPG",
           "found YUYV 640x480, 1280x720; H264 640x480"});
  refused({.left = "/dev/video7"}, {"/dev/video7", "No such file"});
  camera.is_busy = true;
  refused({.left = "/dev/video0", .size = {320, 480}}, {"/dev/video0", "used by another program"});
  camera.is_busy = false;
  video.add("/dev/video1").capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  refused({.left = "/dev/video1"}, {"/dev/video1", "a camera (V4L2) that streams images", "Fake camera"});
  video.add("/dev/video2").formats = {{V4L2_PIX_FMT_GREY, 5, 2}};
  refused({.left = "/dev/video2"}, {"/dev/video2", "an even number", "5"});
  refused({.left = "/dev/video0", .right = "/dev/video2"},
          {"/dev/video2", "640x480 pixels as of /dev/video0", "5x2"});
  // No video device at all.
  test::expect_error<InputError>([&] { VideoStream({.left = "/dev/null"}); },
                                 {"/dev/null", "a camera (V4L2) that streams images", "no video device"});
}

}  // namespace
}  // namespace penumbra::slam
