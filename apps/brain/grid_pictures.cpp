#include "apps/brain/grid_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "nn/image/drawing.h"

namespace penumbra::apps {

namespace {

using slam::brain::Autocorrelogram;
using slam::brain::GridMeasurement;
using slam::brain::HeadDirectionRing;
using slam::brain::LateralRule;
using slam::brain::RateMap;

constexpr Bgr kBlue{178, 114, 0}, kGreen{115, 158, 0}, kOrange{0, 159, 230}, kRed{0, 94, 213};
constexpr Bgr kColours[] = {kBlue, kGreen, kOrange, slam::kFaintInk, kRed, {167, 121, 204}};

// ----- rate maps -----

constexpr int kCellsShown = 6, kMapSide = 92, kGap = 6, kLabel = 150, kCaption = 16;

// Dark blue over green to yellow, for 0..1.
Bgr heat_colour(float value) {
  constexpr float kStops[5][3] = {{84, 1, 68}, {139, 82, 59}, {140, 145, 33}, {98, 201, 94}, {37, 231, 253}};
  const float at = 4.0F * std::clamp(value, 0.0F, 1.0F);
  const int low = std::min(3, static_cast<int>(at));
  const float share = at - static_cast<float>(low);
  Bgr colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    colour[c] = static_cast<std::uint8_t>(
        std::lround(kStops[low][c] + share * (kStops[low + 1][c] - kStops[low][c])));
  }
  return colour;
}

// value(column, row from below) in 0..1, below 0: paper.
template <class Value>
void paint_square(ByteImage& picture, int left, int top, int size, const Value& value) {
  for (int y = 0; y < kMapSide; ++y) {
    for (int x = 0; x < kMapSide; ++x) {
      const float here = value(x * size / kMapSide, size - 1 - y * size / kMapSide);
      const Bgr colour = here < 0.0F ? slam::kPaper : heat_colour(here);
      std::copy(colour.begin(), colour.end(), picture.row(top + y) + 3 * (left + x));
    }
  }
}

void paint_cell(ByteImage& picture, int left, int top, const RateMap& map, double gridness) {
  const float most = std::max(1e-6F, *std::max_element(map.rate.begin(), map.rate.end()));
  paint_square(picture, left, top, map.size, [&](int column, int row) {
    const auto bin = static_cast<std::size_t>(row * map.size + column);
    return map.known[bin] != 0 ? map.rate[bin] / most : -1.0F;
  });
  const Autocorrelogram correlogram = autocorrelogram(map);
  paint_square(picture, left + kMapSide + 2, top, 2 * correlogram.radius + 1, [&](int column, int row) {
    return 0.5F + 0.5F * correlogram.at(column - correlogram.radius, row - correlogram.radius);
  });
  draw_text(picture, fmt::format("{:.2f}", gridness),
            {left + kMapSide - 12.0, static_cast<double>(top + kMapSide + 12)}, 9.0, slam::kInk);
}

struct MapRow {
  std::string label;
  const GridMeasurement* measured;
};

std::vector<MapRow> map_rows(const std::vector<SurveyRow>& rows) {
  std::vector<MapRow> result;
  for (const SurveyRow& row : rows) {
    const bool over_time = result.empty();
    if (!over_time && (row.settings.boundary_factor || row.settings.rule.lateral == LateralRule::none))
      continue;
    for (std::size_t i = over_time ? 0 : row.examples.size() - 1; i < row.examples.size(); ++i) {
      if (!row.examples[i].finite) continue;
      result.push_back(
          {row.untrained ? row.name : fmt::format("{}, {:.0f} s", row.name, row.points[i].seconds),
           &row.examples[i]});
    }
  }
  return result;
}

// ----- growth -----

struct Panel {
  double left, bottom, width, height, low, high, seconds;
  Point2 at(double time, double value) const {
    return {left + width * time / seconds, bottom - height * (value - low) / (high - low)};
  }
};

template <class Value>
void draw_panel(slam::PlotCanvas& canvas, const Panel& panel, const std::string& title,
                const std::vector<SurveyRow>& rows, const Value& value) {
  canvas.text(title, {panel.left, panel.bottom - panel.height - 16.0}, 13, slam::Anchor::left, slam::kInk,
              true);
  const double step = slam::round_step((panel.high - panel.low) / 8.0);
  for (double y = std::ceil(panel.low / step) * step; y <= panel.high + 1e-9; y += step) {
    canvas.line(panel.at(0.0, y), panel.at(panel.seconds, y), 1.0, slam::kGrid);
    canvas.text(fmt::format("{:.1f}", std::abs(y) < 1e-9 ? 0.0 : y),
                {panel.left - 8.0, panel.at(0.0, y).y + 4.0}, 11, slam::Anchor::right, slam::kFaintInk);
  }
  for (const SurveyPoint& point : rows.front().points) {
    canvas.text(fmt::format("{:.0f} s", point.seconds), {panel.at(point.seconds, 0.0).x, panel.bottom + 20.0},
                11, slam::Anchor::centre, slam::kFaintInk);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Bgr& colour = kColours[i % std::size(kColours)];
    std::vector<Point2> points;
    for (const SurveyPoint& point : rows[i].points) points.push_back(panel.at(point.seconds, value(point)));
    if (rows[i].untrained) points.insert(points.begin(), panel.at(0.0, value(rows[i].points.front())));
    for (const Point2& point : points) canvas.disc(point, 3.0, colour);
    canvas.polyline(std::move(points), 2.0, colour);
  }
}

}  // namespace

ByteImage draw_rate_maps(const std::vector<SurveyRow>& rows) {
  const std::vector<MapRow> shown = map_rows(rows);
  constexpr int kCellWidth = 2 * kMapSide + 2 + 2 * kGap, kRowHeight = kMapSide + kCaption + kGap;
  ByteImage picture = ByteImage::filled(kLabel + kCellsShown * kCellWidth,
                                        static_cast<int>(shown.size()) * kRowHeight + kGap, 255, 3);
  for (std::size_t row = 0; row < shown.size(); ++row) {
    const int top = kGap + static_cast<int>(row) * kRowHeight;
    draw_text(picture, shown[row].label, {8.0, top + 0.5 * kMapSide}, 11.0, slam::kInk);
    const GridMeasurement& measured = *shown[row].measured;
    for (int cell = 0; cell < std::min(kCellsShown, static_cast<int>(measured.frozen.size())); ++cell) {
      paint_cell(picture, kLabel + cell * kCellWidth, top, measured.frozen[static_cast<std::size_t>(cell)],
                 measured.frozen_gridness[static_cast<std::size_t>(cell)]);
    }
  }
  return picture;
}

slam::PlotCanvas draw_growth(const std::vector<SurveyRow>& rows) {
  slam::PlotCanvas canvas(1000, 470);
  const double seconds = rows.front().points.back().seconds;
  canvas.text(fmt::format("What grid cells learn in the {} room", to_string(rows.front().settings.room)),
              {50.0, 32.0}, 17, slam::Anchor::left, slam::kInk, true);
  const Panel gridness{50.0, 370.0, 420.0, 270.0, -0.4, 1.5, seconds};
  const Panel share{540.0, 370.0, 420.0, 270.0, 0.0, 1.0, seconds};
  draw_panel(canvas, gridness, "median gridness, frozen maps", rows,
             [](const SurveyPoint& point) { return point.frozen.median; });
  draw_panel(canvas, share, "share of cells above 0.3, live maps", rows,
             [](const SurveyPoint& point) { return point.live.share; });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double x = 50.0 + 320.0 * static_cast<double>(i / 2), y = 418.0 + 26.0 * static_cast<double>(i % 2);
    canvas.line({x, y - 4.0}, {x + 28.0, y - 4.0}, 2.0, kColours[i % std::size(kColours)]);
    const bool part = rows[i].name.front() == ' ';
    canvas.text(part ? fmt::format("{},{}", rows[i].settings.rule.bipolar ? "paper" : "rectified",
                                   rows[i].name.substr(1))
                     : rows[i].name,
                {x + 36.0, y}, 12, slam::Anchor::left, slam::kInk);
  }
  return canvas;
}

slam::PlotCanvas draw_ring(const HeadDirectionRing& untrained, const HeadDirectionRing& trained) {
  slam::PlotCanvas canvas(640, 360);
  const auto draw = [&](const HeadDirectionRing& ring, Point2 centre, const char* title, const Bgr& colour) {
    constexpr double kRadius = 120.0;
    std::vector<Point2> circle;
    for (int i = 0; i <= 120; ++i) {
      const double angle = i * std::numbers::pi / 60.0;
      circle.push_back({centre.x + kRadius * std::cos(angle), centre.y - kRadius * std::sin(angle)});
    }
    canvas.polyline(std::move(circle), 1.0, slam::kGrid);
    for (const auto direction : ring.weights().colwise()) {
      const Point2 tip{centre.x + kRadius * direction.x(), centre.y - kRadius * direction.y()};
      canvas.line(centre, tip, 1.5, colour);
      canvas.disc(tip, 4.0, colour);
    }
    canvas.text(title, {centre.x, 32.0}, 14, slam::Anchor::centre, slam::kInk, true);
    canvas.text(fmt::format("uneven by {:.2f} degrees at most", ring.unevenness() * 180.0 / std::numbers::pi),
                {centre.x, 340.0}, 12, slam::Anchor::centre, slam::kFaintInk);
  };
  draw(untrained, {160.0, 180.0}, "before", kRed);
  draw(trained, {480.0, 180.0}, "after the turns of 1000 s", kBlue);
  return canvas;
}

}  // namespace penumbra::apps
