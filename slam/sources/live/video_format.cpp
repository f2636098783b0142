#include "slam/sources/live/video_format.h"

#include <fmt/core.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <optional>
#include <vector>

#include "nn/base/error.h"

namespace penumbra::slam {

namespace {

constexpr double kReached = 0.9;           // share of the wanted rate
constexpr std::uint32_t kMostListed = 64;  // formats and sizes of each: drivers have been seen that never end

struct KnownPixels {
  std::uint32_t code;
  VideoPixels pixels;
  const char* name;
};
constexpr std::array kKnown = {
    KnownPixels{V4L2_PIX_FMT_GREY, VideoPixels::grey, "GREY"},
    KnownPixels{V4L2_PIX_FMT_YUYV, VideoPixels::yuyv, "YUYV"},
    KnownPixels{V4L2_PIX_FMT_UYVY, VideoPixels::uyvy, "UYVY"},
    KnownPixels{V4L2_PIX_FMT_MJPEG, VideoPixels::mjpg, "MJPG"},
    KnownPixels{V4L2_PIX_FMT_JPEG, VideoPixels::mjpg, "JPEG"},
};

std::string code_text(std::uint32_t code) {
  std::string text;
  for (int i = 0; i < 4; ++i, code >>= 8U) {
    const char c = static_cast<char>(code & 0x7FU);
    text += c >= ' ' && c != 0x7F ? c : '?';
  }
  return text;
}

// The driver's own words, which need not end in a zero.
template <std::size_t kBytes>
std::string driver_text(const __u8 (&bytes)[kBytes]) {
  const auto* const text = reinterpret_cast<const char*>(bytes);
  return {text, ::strnlen(text, kBytes)};
}

class Negotiation {
 public:
  Negotiation(VideoCalls& calls, int descriptor, const std::string& device)
      : calls_(calls), descriptor_(descriptor), device_(device) {}

  void require_camera() const {
    v4l2_capability capability{};
    const std::string expected = "a camera (V4L2) that streams images";
    if (!control(VIDIOC_QUERYCAP, capability)) throw InputError(device_, expected, "no video device");
    const std::uint32_t can = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps
                                                                                    : capability.capabilities;
    if ((can & V4L2_CAP_VIDEO_CAPTURE) != 0 && (can & V4L2_CAP_STREAMING) != 0) return;
    const std::string card = driver_text(capability.card);
    throw InputError(device_, expected,
                     (can & V4L2_CAP_META_CAPTURE) != 0
                         ? fmt::format("the one for what '{}' says about its images; they come from another, "
                                       "mostly the number before",
                                       card)
                         : fmt::format("'{}', which does not", card));
  }

  std::vector<std::uint32_t> offered() const {
    std::vector<std::uint32_t> codes;
    v4l2_fmtdesc description{};
    description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    for (; description.index < kMostListed && control(VIDIOC_ENUM_FMT, description); ++description.index)
      codes.push_back(description.pixelformat);
    return codes;
  }

  // What the camera stands at.
  Size current_size() const {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (!control(VIDIOC_G_FMT, format)) fail("says no size");
    return {static_cast<int>(format.fmt.pix.width), static_cast<int>(format.fmt.pix.height)};
  }

  // Nothing where the camera has other pixels, or others of that size.
  std::optional<VideoFormat> try_format(const KnownPixels& known, const Size& size, double rate) const {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    format.fmt.pix.width = static_cast<__u32>(size.width);
    format.fmt.pix.height = static_cast<__u32>(size.height);
    format.fmt.pix.pixelformat = known.code;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    if (!control(VIDIOC_S_FMT, format)) {
      if (errno == EBUSY) fail("is used by another program");
      return std::nullopt;
    }
    const v4l2_pix_format& pix = format.fmt.pix;
    const bool as_asked = pix.pixelformat == known.code && pix.width == static_cast<__u32>(size.width) &&
                          pix.height == static_cast<__u32>(size.height) &&
                          (pix.field == V4L2_FIELD_NONE || pix.field == V4L2_FIELD_ANY);
    if (!as_asked) return std::nullopt;
    VideoFormat result{.pixels = known.pixels, .size = size};
    const std::size_t pixel_bytes = bytes_per_pixel(known.pixels);
    // Two pixels have their colour together: at an odd width that of the last one would be beyond the line.
    if (pixel_bytes == 2 && size.width % 2 != 0) return std::nullopt;
    if (known.pixels != VideoPixels::mjpg) {
      const std::size_t least = pixel_bytes * static_cast<std::size_t>(size.width);
      result.bytes_per_line = std::max<std::size_t>(pix.bytesperline, least);
    }
    // The default of YCbCr, V4L2_MAP_QUANTIZATION_DEFAULT.
    result.full_range =
        pix.quantization == V4L2_QUANTIZATION_FULL_RANGE ||
        (pix.quantization == V4L2_QUANTIZATION_DEFAULT && pix.colorspace == V4L2_COLORSPACE_JPEG);
    result.rate = set_rate(rate);
    return result;
  }

  // For messages: "YUYV 640x480, 1280x480; MJPG 1920x1080".
  std::string offer_text() const {
    std::string text;
    for (const std::uint32_t code : offered()) {
      text += (text.empty() ? "" : "; ") + code_text(code);
      v4l2_frmsizeenum size{};
      size.pixel_format = code;
      for (; size.index < kMostListed && control(VIDIOC_ENUM_FRAMESIZES, size); ++size.index) {
        const char* const comma = size.index == 0 ? " " : ", ";
        if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
          text += fmt::format("{}{}x{}", comma, size.discrete.width, size.discrete.height);
          continue;
        }
        text += fmt::format("{}{}x{} to {}x{}", comma, size.stepwise.min_width, size.stepwise.min_height,
                            size.stepwise.max_width, size.stepwise.max_height);
        break;
      }
    }
    return text.empty() ? "no format" : text;
  }

  [[noreturn]] void fail(const char* what) const { throw Error(fmt::format("{}: {}", device_, what)); }

 private:
  template <class Argument>
  bool control(unsigned long request, Argument& argument) const {
    return calls_.control(descriptor_, request, &argument) == 0;
  }

  // Returns what the driver makes of it, Hz; 0 where it does not say.
  double set_rate(double rate) const {
    v4l2_streamparm parameters{};
    parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    v4l2_fract& period = parameters.parm.capture.timeperframe;
    period.numerator = 1000;
    period.denominator = static_cast<__u32>(std::lround(1000.0 * rate));
    if (!control(VIDIOC_S_PARM, parameters) || period.numerator == 0 || period.denominator == 0) return 0.0;
    return static_cast<double>(period.denominator) / period.numerator;
  }

  VideoCalls& calls_;
  const int descriptor_;
  const std::string& device_;
};

}  // namespace

const char* name_of(VideoPixels pixels) {
  for (const KnownPixels& known : kKnown) {
    if (known.pixels == pixels) return known.name;
  }
  return "?";
}

VideoFormat negotiate_format(VideoCalls& calls, int descriptor, const std::string& device,
                             const VideoRequest& request) {
  const Negotiation camera(calls, descriptor, device);
  camera.require_camera();
  const std::vector<std::uint32_t> offered = camera.offered();
  const bool any_size = request.size.width == 0 || request.size.height == 0;
  const Size size = any_size ? camera.current_size() : request.size;
  const double rate = request.rate > 0.0 ? request.rate : kUsualVideoRate;
  const KnownPixels* chosen = nullptr;
  const KnownPixels* last = nullptr;
  VideoFormat best;
  for (const KnownPixels& known : kKnown) {
    if (std::find(offered.begin(), offered.end(), known.code) == offered.end()) continue;
    const std::optional<VideoFormat> format = camera.try_format(known, size, rate);
    if (!format) continue;
    last = &known;
    if (chosen == nullptr || format->rate > best.rate) {
      chosen = &known;
      best = *format;
    }
    if (best.rate >= kReached * rate) break;
  }
  if (chosen == nullptr) {
    throw InputError(
        device, fmt::format("images of {}x{} pixels as GREY, YUYV, UYVY or MJPG", size.width, size.height),
        camera.offer_text());
  }
  if (last != chosen) {
    const std::optional<VideoFormat> again = camera.try_format(*chosen, size, rate);
    if (!again) camera.fail("refuses the format that it had accepted");
    best = *again;
  }
  return best;
}

}  // namespace penumbra::slam
