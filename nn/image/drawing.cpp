#include "nn/image/drawing.h"

#include <cmath>
#include <vector>

#include "nn/image/stroke_font.h"

namespace penumbra {

namespace {

// How much of each pixel of a rectangle a shape covers.
class Coverage {
 public:
  // Of a shape between `low` and `high`.
  Coverage(const ByteImage& picture, Point2 low, Point2 high) {
    const auto pixel = [](double value, double limit) {
      return static_cast<int>(std::clamp(value, 0.0, limit));
    };
    const double right = picture.width(), bottom = picture.height();
    area_.x = pixel(std::floor(low.x - 1.0), right);
    area_.y = pixel(std::floor(low.y - 1.0), bottom);
    area_.width = pixel(std::ceil(high.x + 2.0), right) - area_.x;
    area_.height = pixel(std::ceil(high.y + 2.0), bottom) - area_.y;
    if (area_.empty()) area_ = {};
    shares_.assign(static_cast<std::size_t>(area_.area()), 0.0F);
  }

  // `distance(x, y)`: of a part of the shape that lies between `low` and `high`.
  template <class Distance>
  void add(Point2 low, Point2 high, const Distance& distance) {
    const auto bound = [](double value, int least, int most) {
      return static_cast<int>(std::clamp(value, static_cast<double>(least), static_cast<double>(most)));
    };
    const int x0 = bound(std::floor(low.x - 1.0), area_.x, area_.x + area_.width);
    const int x1 = bound(std::ceil(high.x + 2.0), area_.x, area_.x + area_.width);
    const int y0 = bound(std::floor(low.y - 1.0), area_.y, area_.y + area_.height);
    const int y1 = bound(std::ceil(high.y + 2.0), area_.y, area_.y + area_.height);
    for (int y = y0; y < y1; ++y) {
      float* row = shares_.data() + static_cast<std::ptrdiff_t>(y - area_.y) * area_.width - area_.x;
      for (int x = x0; x < x1; ++x) {
        const double share = std::clamp(0.5 - distance(x, y), 0.0, 1.0);
        row[x] = std::max(row[x], static_cast<float>(share));
      }
    }
  }

  void add_segment(Point2 a, Point2 b, double width) {
    const double radius = 0.5 * width, dx = b.x - a.x, dy = b.y - a.y;
    const double squared_length = dx * dx + dy * dy;
    const Point2 low{std::min(a.x, b.x) - radius, std::min(a.y, b.y) - radius};
    const Point2 high{std::max(a.x, b.x) + radius, std::max(a.y, b.y) + radius};
    add(low, high, [=](double x, double y) {
      const double along = (x - a.x) * dx + (y - a.y) * dy;
      const double t = squared_length > 0.0 ? std::clamp(along / squared_length, 0.0, 1.0) : 0.0;
      return std::hypot(x - a.x - t * dx, y - a.y - t * dy) - radius;
    });
  }

  void paint(ByteImage& picture, const Bgr& colour) const {
    for (int y = 0; y < area_.height; ++y) {
      const float* share = shares_.data() + static_cast<std::ptrdiff_t>(y) * area_.width;
      for (int x = 0; x < area_.width; ++x) {
        if (share[x] == 0.0F) continue;
        std::uint8_t* pixel = &picture.at(area_.x + x, area_.y + y);
        for (std::size_t c = 0; c < 3; ++c) {
          const float mixed = (1.0F - share[x]) * pixel[c] + share[x] * colour[c];
          pixel[c] = static_cast<std::uint8_t>(mixed + 0.5F);
        }
      }
    }
  }

 private:
  Rect area_;
  std::vector<float> shares_;
};

}  // namespace

void draw_polyline(ByteImage& picture, std::span<const Point2> points, double width, const Bgr& colour) {
  if (points.empty()) return;
  Point2 low = points.front(), high = low;
  for (const Point2& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  Coverage coverage(picture, {low.x - width, low.y - width}, {high.x + width, high.y + width});
  coverage.add_segment(points.front(), points.front(), width);
  for (std::size_t i = 1; i < points.size(); ++i) coverage.add_segment(points[i - 1], points[i], width);
  coverage.paint(picture, colour);
}

void draw_line(ByteImage& picture, Point2 a, Point2 b, double width, const Bgr& colour) {
  const std::array<Point2, 2> ends{a, b};
  draw_polyline(picture, ends, width, colour);
}

void draw_disc(ByteImage& picture, Point2 centre, double radius, const Bgr& colour) {
  draw_line(picture, centre, centre, 2.0 * radius, colour);
}

void draw_box(ByteImage& picture, Point2 low, Point2 high, const Bgr& colour, double width) {
  const Point2 first{std::min(low.x, high.x), std::min(low.y, high.y)};
  const Point2 last{std::max(low.x, high.x), std::max(low.y, high.y)};
  const double half = 0.5 * width;
  const Point2 outer_low{first.x - half, first.y - half}, outer_high{last.x + half, last.y + half};
  Coverage coverage(picture, outer_low, outer_high);
  coverage.add(outer_low, outer_high, [&](double x, double y) {
    const double inside = std::min(std::min(x - first.x, last.x - x), std::min(y - first.y, last.y - y));
    return width > 0.0 ? std::abs(inside) - half : -inside;
  });
  coverage.paint(picture, colour);
}

void draw_text(ByteImage& picture, std::string_view text, Point2 origin, double height, const Bgr& colour,
               bool bold) {
  const double scale = height / kCapitalHeight, width = std::max(1.0, (bold ? 0.2 : 0.11) * height);
  const Point2 low{origin.x - width, origin.y - height - width};
  const Point2 high{origin.x + text_width(text, height) + width, origin.y + 0.5 * height + width};
  Coverage coverage(picture, low, high);
  double x = origin.x;
  for (const char letter : text) {
    const Glyph glyph = glyph_of(letter);
    for_each_stroke(glyph, [&](int from_x, int from_y, int to_x, int to_y) {
      coverage.add_segment({x + scale * from_x, origin.y - scale * from_y},
                           {x + scale * to_x, origin.y - scale * to_y}, width);
    });
    x += scale * glyph.advance;
  }
  coverage.paint(picture, colour);
}

double text_width(std::string_view text, double height) {
  double units = 0.0;
  for (const char letter : text) units += glyph_of(letter).advance;
  return units * height / kCapitalHeight;
}

}  // namespace penumbra
