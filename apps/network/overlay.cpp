#include "apps/network/overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "nn/image/colour.h"
#include "nn/image/drawing.h"
#include "nn/image/resize.h"

namespace penumbra::apps {

namespace {

constexpr int kSmallestWidth = 640;  // pixels
constexpr double kMaskOpacity = 0.45;

// The mask as an image of `size` pixels, 0 or 255.
ByteImage full_mask(const nn::Mask& mask, const Size& image, const Size& size) {
  ByteImage full = ByteImage::filled(image.width, image.height, 0);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      if (mask.contains(mask.x + x, mask.y + y)) full.at(mask.x + x, mask.y + y) = 255;
    }
  }
  return size == image ? full : resize_nearest<std::uint8_t>(full, size);
}

void blend(ByteImage& picture, const ByteImage& mask, const Bgr& colour) {
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (mask.at(x, y) == 0) continue;
      std::uint8_t* pixel = &picture.at(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        const double mixed = (1.0 - kMaskOpacity) * pixel[c] + kMaskOpacity * colour[c];
        pixel[c] = static_cast<std::uint8_t>(std::lround(mixed));
      }
    }
  }
}

// Two pixels wide: those of the mask that have a neighbour outside of it, and these neighbours.
void outline(ByteImage& picture, const ByteImage& mask, const Bgr& colour) {
  const auto inside = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < mask.width() && y < mask.height() && mask.at(x, y) != 0;
  };
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      const bool here = inside(x, y);
      if (inside(x - 1, y) != here || inside(x + 1, y) != here || inside(x, y - 1) != here ||
          inside(x, y + 1) != here) {
        std::copy(colour.begin(), colour.end(), &picture.at(x, y));
      }
    }
  }
}

}  // namespace

ByteImage readable_picture(const ByteImage& image, double& scale) {
  scale = std::max(1.0, static_cast<double>(kSmallestWidth) / image.width());
  ByteImage picture = image.channels() == 1 ? grey_to_bgr(image.view()) : image.clone();
  if (scale > 1.0) {
    const auto enlarged = [scale](int extent) { return static_cast<int>(std::lround(extent * scale)); };
    picture = resize_linear(picture, {enlarged(image.width()), enlarged(image.height())});
  }
  return picture;
}

Bgr instance_colour(std::size_t i) {
  constexpr double kSaturation = 200.0 / 255.0;
  const double hue = 6.0 * std::fmod(0.09 + 0.61803398875 * static_cast<double>(i), 1.0);
  // Source: the usual hexagon of hue, saturation and value, of which the value is 1.
  const auto level = [&](double sector) {
    const double k = std::fmod(sector + hue, 6.0);
    return static_cast<std::uint8_t>(
        std::lround(255.0 * (1.0 - kSaturation * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0))));
  };
  return {level(1.0), level(3.0), level(5.0)};
}

void draw_label(ByteImage& picture, const std::string& text, int x, int y, const Bgr& colour) {
  constexpr double kCapital = 10.0, kMargin = 3.0, kBelow = 4.0;
  const double width = text_width(text, kCapital) + 2.0 * kMargin, height = kCapital + kBelow + 2.0 * kMargin;
  const double left = std::clamp<double>(x, 0.0, std::max(picture.width() - width, 0.0));
  const double top = std::clamp<double>(y - height, 0.0, std::max(picture.height() - height, 0.0));
  draw_box(picture, {left, top}, {left + width, top + height}, colour);
  draw_text(picture, text, {left + kMargin, top + kMargin + kCapital}, kCapital, {0, 0, 0});
}

ByteImage draw_overlay(const ByteImage& image, const std::vector<nn::Detection>& detections,
                       const std::vector<std::string>& names, float min_score) {
  double scale = 1.0;
  ByteImage picture = readable_picture(image, scale);

  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < detections.size(); ++i) {
    if (detections[i].score >= min_score) shown.push_back(i);
  }
  for (const std::size_t i : shown) {
    const ByteImage mask = full_mask(detections[i].mask, image.size(), picture.size());
    blend(picture, mask, instance_colour(i));
    outline(picture, mask, instance_colour(i));
  }
  // Boxes and labels above all masks, the best scores last and so on top.
  for (auto it = shown.rbegin(); it != shown.rend(); ++it) {
    const nn::Detection& detection = detections[*it];
    const auto pixel = [&](float value) { return static_cast<int>(std::lround(value * scale)); };
    const int left = pixel(detection.box.x1), top = pixel(detection.box.y1);
    const double right = pixel(detection.box.x2), bottom = pixel(detection.box.y2);
    draw_box(picture, {static_cast<double>(left), static_cast<double>(top)}, {right, bottom},
             instance_colour(*it), 1.0);
    draw_label(picture,
               fmt::format("{} {:.2f}", names[static_cast<std::size_t>(detection.label)], detection.score),
               left, top, instance_colour(*it));
  }
  return picture;
}

}  // namespace penumbra::apps
