#include "slam/sources/live/frame_stream.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/image/image_container.h"
#include "nn/image/yuv.h"

namespace penumbra::slam {

namespace {

constexpr std::size_t kLongestLine = 1024;

std::string place_in(const ByteInput& input) {
  return fmt::format("{}, byte {}", input.name(), input.position());
}

int whole_number(std::string_view text, const std::string& place) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw InputError(place, "a number", fmt::format("'{}'", printable(text, 40)));
  return value;
}

// The words of a header behind the first, by their first letter.
struct Header {
  int width = 0, height = 0;
  double rate = 0.0;  // Hz; 0 where it is not said
  std::string chroma = "420", interlacing = "p", range;
};

Header parse_header(const std::string& line, const std::string& place) {
  Header header;
  std::istringstream words(line);
  std::string word;
  words >> word;
  while (words >> word) {
    const std::string_view value = std::string_view(word).substr(1);
    const std::size_t colon = value.find(':');
    switch (word.front()) {
      case 'W':
        header.width = whole_number(value, place);
        break;
      case 'H':
        header.height = whole_number(value, place);
        break;
      case 'F':
        if (colon != std::string_view::npos) {
          const int over = whole_number(value.substr(0, colon), place),
                    under = whole_number(value.substr(colon + 1), place);
          if (over > 0 && under > 0) header.rate = static_cast<double>(over) / under;
        }
        break;
      case 'C':
        header.chroma = value;
        break;
      case 'I':
        header.interlacing = value;
        break;
      case 'X':
        if (value.starts_with("COLORRANGE=")) header.range = value.substr(11);
        break;
      default:
        break;
    }
  }
  if (header.width < 2 || header.height < 2 ||
      static_cast<long>(header.width) * header.height > nn::kMaxImagePixels)
    throw InputError(place, "a width and a height (W640 H480)", fmt::format("'{}'", printable(line, 80)));
  return header;
}

// A stream of bytes.
class ByteStream : public FrameStream {
 public:
  explicit ByteStream(ByteInput& input) : input_(input) {}
  std::string name() const override { return input_.name(); }
  void stop() override { input_.stop(); }

 protected:
  ByteInput& input_;
};

class Y4mStream final : public ByteStream {
 public:
  Y4mStream(ByteInput& input, const Header& header, StereoLayout layout, double rate)
      : ByteStream(input), width_(header.width), height_(header.height), layout_(layout), rate_(rate) {
    const std::string& c = header.chroma;
    if (c == "mono") {
      step_x_ = 0;
    } else if (c == "420" || c == "420jpeg" || c == "420mpeg2" || c == "420paldv") {
      step_x_ = step_y_ = 2;
    } else if (c == "422") {
      step_x_ = 2;
    } else if (c != "444") {
      throw InputError(place_in(input), "8-bit mono, 420, 422 or 444 (ffmpeg -pix_fmt gray or yuv420p)",
                       fmt::format("C{}", printable(c, 40)));
    }
    if (header.interlacing != "p" && header.interlacing != "?")
      throw InputError(place_in(input), "whole images (ffmpeg -vf yadif)",
                       "interlaced ones, I" + header.interlacing);
    is_full_range_ = header.range == "FULL" || (header.range.empty() && (c == "420jpeg" || c == "mono"));
    const bool beside = layout == StereoLayout::side_by_side;
    if ((beside ? width_ : height_) % 2 != 0)
      throw InputError(place_in(input),
                       beside ? "an even width of two images side by side"
                              : "an even height of two images one above the other",
                       fmt::format("{} x {}", width_, height_));
  }

  bool has_times() const override { return false; }
  Sensor sensor() const override { return Sensor::stereo; }
  Size size() const override {
    return layout_ == StereoLayout::side_by_side ? Size{width_ / 2, height_} : Size{width_, height_ / 2};
  }
  bool read(StreamFrame& frame) override {
    const std::optional<std::string> line = input_.read_line(kLongestLine);
    if (!line) return false;
    if (!line->starts_with("FRAME"))
      throw InputError(place_in(input_), "FRAME", fmt::format("'{}'", printable(*line, 40)));
    frame.bytes.resize(luma_bytes() + 2 * chroma_bytes());
    if (input_.read(frame.bytes.data(), frame.bytes.size()) < frame.bytes.size()) return false;
    frame.index = count_++;
    frame.timestamp = frame.index / rate_;
    return true;
  }
  void images(const StreamFrame& frame, bool colour, ByteImage& left, ByteImage& right,
              WordImage&) const override {
    const Size one = size();
    const bool beside = layout_ == StereoLayout::side_by_side;
    left = image(frame, colour, 0, 0, one);
    right = image(frame, colour, beside ? one.width : 0, beside ? 0 : one.height, one);
  }

 private:
  std::size_t luma_bytes() const {
    return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  }
  int chroma_width() const { return step_x_ == 0 ? 0 : (width_ + step_x_ - 1) / step_x_; }
  int chroma_height() const { return step_x_ == 0 ? 0 : (height_ + step_y_ - 1) / step_y_; }
  std::size_t chroma_bytes() const {
    return static_cast<std::size_t>(chroma_width()) * static_cast<std::size_t>(chroma_height());
  }

  ByteImage image(const StreamFrame& frame, bool colour, int x0, int y0, const Size& one) const {
    const std::uint8_t* const luma = frame.bytes.data();
    ByteImage image(one.width, one.height, colour ? 3 : 1);
    for (int y = 0; y < one.height; ++y) {
      const std::uint8_t* const row = luma + static_cast<std::ptrdiff_t>(y0 + y) * width_ + x0;
      if (colour) {
        colour_row(frame, row, x0, y0 + y, one.width, image.row(y));
      } else {
        std::copy_n(row, one.width, image.row(y));
      }
    }
    return image;
  }

  void colour_row(const StreamFrame& frame, const std::uint8_t* luma, int x0, int y, int width,
                  std::uint8_t* bgr) const {
    const bool has_chroma = step_x_ > 0;
    const std::uint8_t* const u_plane = frame.bytes.data() + luma_bytes();
    const std::uint8_t* const v_plane = u_plane + chroma_bytes();
    const std::ptrdiff_t line = has_chroma ? static_cast<std::ptrdiff_t>(y / step_y_) * chroma_width() : 0;
    const YuvRange& range = is_full_range_ ? kFullRange : kVideoRange;
    for (int x = 0; x < width; ++x, bgr += 3) {
      constexpr int kGrey = 128;
      const std::ptrdiff_t at = has_chroma ? line + (x0 + x) / step_x_ : 0;
      put_bgr(range, luma[x], has_chroma ? u_plane[at] : kGrey, has_chroma ? v_plane[at] : kGrey, bgr);
    }
  }

  const int width_, height_;
  const StereoLayout layout_;
  const double rate_;
  int step_x_ = 1, step_y_ = 1;  // pixels a chroma sample; 0: none
  bool is_full_range_ = false;
  int count_ = 0;
};

class RgbdStream final : public ByteStream {
 public:
  RgbdStream(ByteInput& input, const Header& header)
      : ByteStream(input), size_{header.width, header.height} {}

  bool has_times() const override { return true; }
  Sensor sensor() const override { return Sensor::rgbd; }
  Size size() const override { return size_; }
  bool read(StreamFrame& frame) override {
    const std::optional<std::string> line = input_.read_line(kLongestLine);
    if (!line) return false;
    std::int64_t nanoseconds = 0;
    const std::string_view text = *line;
    const bool is_frame = text.starts_with("FRAME ");
    const auto [end, error] = std::from_chars(text.data() + std::min<std::size_t>(6, text.size()),
                                              text.data() + text.size(), nanoseconds);
    if (!is_frame || error != std::errc() || end != text.data() + text.size())
      throw InputError(place_in(input_), "FRAME and its time in nanoseconds",
                       fmt::format("'{}'", printable(text, 40)));
    frame.bytes.resize(5 * pixels());
    if (input_.read(frame.bytes.data(), frame.bytes.size()) < frame.bytes.size()) return false;
    frame.index = count_++;
    frame.timestamp = static_cast<double>(nanoseconds) * 1e-9;
    return true;
  }
  void images(const StreamFrame& frame, bool, ByteImage& left, ByteImage&, WordImage& depth) const override {
    left = ByteImage(size_.width, size_.height, 3);
    depth = WordImage(size_.width, size_.height);
    const std::uint8_t* bytes = frame.bytes.data();
    for (int y = 0; y < size_.height; ++y, bytes += 3 * size_.width)
      std::copy_n(bytes, 3 * size_.width, left.row(y));
    for (int y = 0; y < size_.height; ++y) {
      std::uint16_t* const row = depth.row(y);
      for (int x = 0; x < size_.width; ++x, bytes += 2)
        row[x] = static_cast<std::uint16_t>(bytes[0] | static_cast<unsigned>(bytes[1]) << 8U);
    }
  }

 private:
  std::size_t pixels() const {
    return static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height);
  }

  const Size size_;
  int count_ = 0;
};

}  // namespace

std::unique_ptr<FrameStream> open_frame_stream(ByteInput& input, StereoLayout layout,
                                               std::optional<double> rate) {
  const std::string expected = "a stream of frames: YUV4MPEG2 (ffmpeg -f yuv4mpegpipe) or PENUMBRA-RGBD";
  const std::optional<std::string> line = input.read_line(kLongestLine);
  if (!line) throw InputError(input.name(), expected, input.position() == 0 ? "nothing" : "no line");
  if (line->starts_with("PENUMBRA-RGBD ")) {
    return std::make_unique<RgbdStream>(input, parse_header(*line, place_in(input)));
  }
  if (!line->starts_with("YUV4MPEG2 "))
    throw InputError(input.name(), expected, fmt::format("'{}'", printable(*line, 40)));
  const Header header = parse_header(*line, place_in(input));
  const double hertz = rate.value_or(header.rate);
  if (!(hertz > 0.0)) throw InputError(place_in(input), "a frame rate (F20:1), or --rate HZ", "neither");
  return std::make_unique<Y4mStream>(input, header, layout, hertz);
}

}  // namespace penumbra::slam
