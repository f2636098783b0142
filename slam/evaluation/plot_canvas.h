// What the plots are drawn on: a list of shapes, which becomes an SVG or a picture of pixels.
#pragma once

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "nn/image/drawing.h"

namespace penumbra::slam {

// Plots take their colours from Okabe and Ito's palette, told apart by colour-blind readers too.
inline constexpr Bgr kPaper{255, 255, 255}, kInk{45, 45, 45}, kFaintInk{120, 120, 120}, kGrid{232, 232, 232};

enum class Anchor { left, centre, right };

// Coordinates in pixels, y pointing down.
class PlotCanvas {
 public:
  PlotCanvas(int width, int height) : size_{width, height} {}

  Size size() const { return size_; }
  void line(Point2 a, Point2 b, double width, const Bgr& colour) { polyline({a, b}, width, colour); }
  void polyline(std::vector<Point2> points, double width, const Bgr& colour);
  void disc(Point2 centre, double radius, const Bgr& colour);
  // Filled, or its outline where `width` > 0.
  void box(Point2 low, Point2 high, const Bgr& colour, double width = 0.0);
  // Text whose baseline starts, is centred or ends at `position`; `height` of a capital.
  void text(std::string text, Point2 position, double height, Anchor anchor, const Bgr& colour,
            bool bold = false);

  std::string svg() const;
  ByteImage picture() const;  // BGR

 private:
  struct Polyline {
    std::vector<Point2> points;
    double width;
    Bgr colour;
  };
  struct Disc {
    Point2 centre;
    double radius;
    Bgr colour;
  };
  struct Box {
    Point2 low, high;
    double width;
    Bgr colour;
  };
  struct Text {
    std::string text;
    Point2 position;
    double height;
    Anchor anchor;
    Bgr colour;
    bool bold;
  };
  static void paint(const Polyline& line, ByteImage& picture);
  static void paint(const Disc& disc, ByteImage& picture);
  static void paint(const Box& box, ByteImage& picture);
  static void paint(const Text& text, ByteImage& picture);

  Size size_;
  std::vector<std::variant<Polyline, Disc, Box, Text>> shapes_;
};

// As SVG or, by the name's ending, as an image (nn/image/image_file.h). Throws Error where that fails.
void write_plot(const std::filesystem::path& path, const PlotCanvas& plot);

// 1, 2 or 5 times a power of ten, at least `smallest`: the distance of grid lines.
double round_step(double smallest);

}  // namespace penumbra::slam
