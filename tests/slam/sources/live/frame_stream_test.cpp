#include "slam/sources/live/frame_stream.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <thread>

#include "nn/base/error.h"
#include "tests/support/expect_error.h"

namespace penumbra::slam {
namespace {

using test::expect_error;

// A pipe that a thread fills with `bytes` and closes.
class FilledPipe {
 public:
  explicit FilledPipe(std::string bytes)
      : bytes_(std::move(bytes)), ends_(made()), input_(ends_[0], "pipe"), writer_([this] {
          for (std::size_t done = 0; done < bytes_.size();) {
            const ssize_t count = ::write(ends_[1], bytes_.data() + done, bytes_.size() - done);
            if (count <= 0) break;
            done += static_cast<std::size_t>(count);
          }
          ::close(ends_[1]);
        }) {}
  ~FilledPipe() {
    writer_.join();
    ::close(ends_[0]);
  }
  ByteInput& input() { return input_; }

 private:
  static std::array<int, 2> made() {
    std::array<int, 2> ends{-1, -1};
    if (::pipe(ends.data()) != 0) throw Error("no pipe");
    return ends;
  }
  const std::string bytes_;
  const std::array<int, 2> ends_;
  ByteInput input_;
  std::thread writer_;  // the last: it uses the others
};

struct Images {
  ByteImage left, right;
  WordImage depth;
};

Images images_of(FrameStream& stream, bool colour) {
  StreamFrame frame;
  EXPECT_TRUE(stream.read(frame));
  Images images;
  stream.images(frame, colour, images.left, images.right, images.depth);
  return images;
}

TEST(FrameStream, TakesTheHalvesOfYuv4mpeg2Apart) {
  FilledPipe beside(
      "YUV4MPEG2 W4 H2 F20:1 Ip A1:1 Cmono\nFRAME\n\x01\x02\x0b\x0c\x03\x04\x0d\x0e"
      "FRAME Ip\nabcdefgh");
  const auto stream = open_frame_stream(beside.input(), StereoLayout::side_by_side, std::nullopt);
  EXPECT_EQ(stream->size(), (Size{2, 2}));
  const Images first = images_of(*stream, false);
  EXPECT_EQ(first.left.at(1, 1), 4);
  EXPECT_EQ(first.right.at(0, 0), 0x0b);
  EXPECT_EQ(first.right.at(1, 1), 0x0e);
  StreamFrame second;
  ASSERT_TRUE(stream->read(second));
  EXPECT_EQ(second.index, 1);
  EXPECT_DOUBLE_EQ(second.timestamp, 0.05);
  EXPECT_FALSE(stream->read(second));

  FilledPipe above("YUV4MPEG2 W2 H4 F30000:1001 Cmono\nFRAME\nabcdefgh");
  const auto over = open_frame_stream(above.input(), StereoLayout::top_bottom, std::nullopt);
  EXPECT_EQ(over->size(), (Size{2, 2}));
  const Images images = images_of(*over, false);
  EXPECT_EQ(images.left.at(1, 1), 'd');
  EXPECT_EQ(images.right.at(0, 0), 'e');
}

// Grey has u = v = 128; pure red of full range is Y 76, U 85, V 255, of video range Y 81, U 90, V 240.
TEST(FrameStream, MakesBgrOfEveryChromaAndRange) {
  const auto colour_of = [](const std::string& chroma, const std::string& y, const std::string& u,
                            const std::string& v, const std::string& words = "") {
    FilledPipe pipe("YUV4MPEG2 W4 H2 F1:1 C" + chroma + words + "\nFRAME\n" + y + u + v);
    const auto stream = open_frame_stream(pipe.input(), StereoLayout::side_by_side, std::nullopt);
    const Images images = images_of(*stream, true);
    EXPECT_EQ(images.right.channels(), 3);
    const std::uint8_t* const pixel = images.right.row(1) + 3;
    return std::array<int, 3>{pixel[0], pixel[1], pixel[2]};
  };
  const auto n = [](std::size_t count, int value) { return std::string(count, static_cast<char>(value)); };
  const auto near = [](const std::array<int, 3>& found, const std::array<int, 3>& expected) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 2);
  };
  near(colour_of("420jpeg", n(8, 76), n(2, 85), n(2, 255)), {0, 0, 255});
  near(colour_of("420mpeg2", n(8, 81), n(2, 90), n(2, 240)), {0, 0, 255});
  near(colour_of("422", n(8, 81), n(4, 90), n(4, 240)), {0, 0, 255});
  near(colour_of("444", n(8, 81), n(8, 90), n(8, 240)), {0, 0, 255});
  near(colour_of("444", n(8, 76), n(8, 85), n(8, 255), " XCOLORRANGE=FULL"), {0, 0, 255});
  near(colour_of("420mpeg2", n(8, 16), n(2, 128), n(2, 128)), {0, 0, 0});
  near(colour_of("420mpeg2", n(8, 235), n(2, 128), n(2, 128)), {255, 255, 255});
  near(colour_of("mono", n(8, 100), "", ""), {100, 100, 100});
}

TEST(FrameStream, TakesDepthBesideColour) {
  FilledPipe pipe(
      "PENUMBRA-RGBD W2 H2\nFRAME 1403636579763555584\nbgrBGRxyzXYZ\x01\x02\x03\x04\x05\x06\x07\x08");
  const auto stream = open_frame_stream(pipe.input(), StereoLayout::side_by_side, std::nullopt);
  EXPECT_EQ(stream->sensor(), Sensor::rgbd);
  StreamFrame frame;
  ASSERT_TRUE(stream->read(frame));
  EXPECT_NEAR(frame.timestamp, 1403636579.763555584, 1e-6);
  Images images;
  stream->images(frame, true, images.left, images.right, images.depth);
  EXPECT_EQ(images.left.row(1)[5], 'Z');
  EXPECT_EQ(images.depth.at(1, 1), 0x0807);
}

TEST(FrameStream, AFrameThatIsCutOffIsNone) {
  FilledPipe pipe("YUV4MPEG2 W4 H2 F20:1 Cmono\nFRAME\nabcdefghFRAME\nabc");
  const auto stream = open_frame_stream(pipe.input(), StereoLayout::side_by_side, std::nullopt);
  StreamFrame frame;
  EXPECT_TRUE(stream->read(frame));
  EXPECT_FALSE(stream->read(frame));
}

TEST(FrameStream, WhatIsNoStreamIsNamed) {
  const auto refused = [](const std::string& bytes, std::initializer_list<std::string> parts,
                          StereoLayout layout = StereoLayout::side_by_side) {
    FilledPipe pipe(bytes);
    expect_error<InputError>(
        [&] {
          const auto stream = open_frame_stream(pipe.input(), layout, std::nullopt);
          StreamFrame frame;
          while (stream->read(frame)) {
          }
        },
        parts);
  };
  refused("", {"pipe", "ffmpeg -f yuv4mpegpipe", "nothing"});
  refused("RIFF....AVI\n", {"'RIFF....AVI'"});
  refused("YUV4MPEG2 W4 F20:1\n", {"a width and a height"});
  refused("YUV4MPEG2 W4 H2\n", {"a frame rate"});
  refused("YUV4MPEG2 W4 H2 F20:1 C420p10\n", {"8-bit mono", "C420p10"});
  refused("YUV4MPEG2 W4 H2 F20:1 It Cmono\n", {"interlaced"});
  refused("YUV4MPEG2 W5 H2 F20:1 Cmono\n", {"an even width"});
  refused("YUV4MPEG2 W4 H3 F20:1 Cmono\n", {"an even height"}, StereoLayout::top_bottom);
  refused("YUV4MPEG2 W4 Hx F20:1\n", {"a number", "'x'"});
  refused("YUV4MPEG2 W4 H2 F20:1 Cmono\nFRANE\n", {"byte 34", "FRAME", "'FRANE'"});
  refused("PENUMBRA-RGBD W2 H2\nFRAME soon\n", {"nanoseconds", "'FRAME soon'"});
  refused(std::string(5000, 'x'), {"a line of at most 1024 bytes"});
}

}  // namespace
}  // namespace penumbra::slam
