#include "slam/evaluation/plot_canvas.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/text.h"
#include "nn/image/image_file.h"

namespace penumbra::slam {

namespace {

std::string hex(const Bgr& colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour[2], colour[1], colour[0]);
}

template <class... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};
template <class... Visitors>
Overloaded(Visitors...) -> Overloaded<Visitors...>;  // clang 14 does not find it by itself

}  // namespace

void PlotCanvas::polyline(std::vector<Point2> points, double width, const Bgr& colour) {
  shapes_.emplace_back(Polyline{std::move(points), width, colour});
}
void PlotCanvas::disc(Point2 centre, double radius, const Bgr& colour) {
  shapes_.emplace_back(Disc{centre, radius, colour});
}
void PlotCanvas::box(Point2 low, Point2 high, const Bgr& colour, double width) {
  const Point2 first{std::min(low.x, high.x), std::min(low.y, high.y)};
  const Point2 last{std::max(low.x, high.x), std::max(low.y, high.y)};
  shapes_.emplace_back(Box{first, last, width, colour});
}
void PlotCanvas::text(std::string text, Point2 position, double height, Anchor anchor, const Bgr& colour,
                      bool bold) {
  shapes_.emplace_back(Text{std::move(text), position, height, anchor, colour, bold});
}

std::string PlotCanvas::svg() const {
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"sans-serif\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"{2}\"/>\n",
      size_.width, size_.height, hex(kPaper));
  const auto to = std::back_inserter(out);
  const Overloaded write{
      [&](const Polyline& s) {
        fmt::format_to(to,
                       "<polyline fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\" stroke-linecap=\"round\" "
                       "stroke-linejoin=\"round\" points=\"",
                       hex(s.colour), s.width);
        for (const Point2& p : s.points) fmt::format_to(to, "{:.2f},{:.2f} ", p.x, p.y);
        out += "\"/>\n";
      },
      [&](const Disc& s) {
        fmt::format_to(to, "<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:g}\" fill=\"{}\"/>\n", s.centre.x,
                       s.centre.y, s.radius, hex(s.colour));
      },
      [&](const Box& s) {
        fmt::format_to(to, "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" ", s.low.x,
                       s.low.y, s.high.x - s.low.x, s.high.y - s.low.y);
        if (s.width > 0.0) {
          fmt::format_to(to, "fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\"/>\n", hex(s.colour), s.width);
        } else {
          fmt::format_to(to, "fill=\"{}\"/>\n", hex(s.colour));
        }
      },
      [&](const Text& s) {
        constexpr double kSizeOfCapital = 0.72;  // of the font's size, in the usual fonts
        const char* anchor = s.anchor == Anchor::left     ? "start"
                             : s.anchor == Anchor::centre ? "middle"
                                                          : "end";
        fmt::format_to(to,
                       "<text x=\"{:.2f}\" y=\"{:.2f}\" font-size=\"{:.3g}\"{} text-anchor=\"{}\" "
                       "fill=\"{}\">{}</text>\n",
                       s.position.x, s.position.y, s.height / kSizeOfCapital,
                       s.bold ? " font-weight=\"bold\"" : "", anchor, hex(s.colour), as_markup(s.text));
      }};
  for (const auto& shape : shapes_) std::visit(write, shape);
  return out + "</svg>\n";
}

void PlotCanvas::paint(const Polyline& s, ByteImage& picture) {
  draw_polyline(picture, s.points, s.width, s.colour);
}
void PlotCanvas::paint(const Disc& s, ByteImage& picture) {
  draw_disc(picture, s.centre, s.radius, s.colour);
}
void PlotCanvas::paint(const Box& s, ByteImage& picture) {
  draw_box(picture, s.low, s.high, s.colour, s.width);
}
void PlotCanvas::paint(const Text& s, ByteImage& picture) {
  const double share = s.anchor == Anchor::left ? 0.0 : s.anchor == Anchor::centre ? 0.5 : 1.0;
  const Point2 origin{s.position.x - share * text_width(s.text, s.height), s.position.y};
  draw_text(picture, s.text, origin, s.height, s.colour, s.bold);
}

ByteImage PlotCanvas::picture() const {
  ByteImage picture = ByteImage::filled(size_.width, size_.height, kPaper[0], 3);
  for (const auto& shape : shapes_) std::visit([&](const auto& s) { paint(s, picture); }, shape);
  return picture;
}

void write_plot(const std::filesystem::path& path, const PlotCanvas& plot) {
  const std::string ending = nn::image_ending(path);
  if (ending == ".svg") {
    nn::write_file(path, plot.svg(), /*durable=*/false);
  } else if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") {
    nn::write_image(path, plot.picture());
  } else {
    throw Error(
        fmt::format("{}: cannot draw the plot: expected a name that ends with .svg, .png or .jpg, found '{}'",
                    path.string(), ending));
  }
}

double round_step(double smallest) {
  const double power = std::pow(10.0, std::floor(std::log10(smallest)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= smallest) return factor * power;
  }
  return 10.0 * power;
}

}  // namespace penumbra::slam
