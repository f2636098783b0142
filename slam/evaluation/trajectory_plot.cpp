#include "slam/evaluation/trajectory_plot.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "slam/evaluation/kitti_metrics.h"
#include "slam/evaluation/plot_canvas.h"

namespace penumbra::slam {

namespace {

// Final pixels.
constexpr int kShortestSide = 1000, kLongestSide = 1500;
constexpr int kMarginLeft = 100, kMarginRight = 50, kMarginTop = 130, kMarginBottom = 90;
constexpr double kLabelDistance = 90.0;  // at least this far apart are grid lines
constexpr int kMostGridLines = 64;
constexpr double kSmallestSpan = 1.0;  // metres shown of a camera that stands still
constexpr double kEmptyBorder = 0.06;  // of the span, on each side of the path

constexpr Bgr kFrame{180, 180, 180}, kTruthColour{150, 150, 150}, kEstimateColour{178, 114, 0},
    kStartColour{115, 158, 0}, kEndColour{0, 94, 213};

std::vector<Point2> project(const Trajectory& trajectory, PlotPlane plane) {
  std::vector<Point2> points;
  points.reserve(trajectory.size());
  for (const TimedPose& pose : trajectory) {
    const Eigen::Vector3d& p = pose.T_wc.translation;
    if (!p.allFinite()) throw Error("cannot draw a trajectory with a position that is not finite");
    points.push_back({p.x(), plane == PlotPlane::xz ? p.z() : p.y()});
  }
  return points;
}

// The part of the world that is shown and where: metres to final pixels.
struct PlotView {
  Size picture;
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;  // of the plot's frame, final pixels
  Point2 low;  // world position of the frame's lower left corner, metres
  double pixels_per_metre = 1.0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
  Point2 to_picture(const Point2& world) const {
    return {left + (world.x - low.x) * pixels_per_metre, bottom() - (world.y - low.y) * pixels_per_metre};
  }
  Point2 high() const { return {low.x + width / pixels_per_metre, low.y + height / pixels_per_metre}; }
};

PlotView make_view(const std::vector<Point2>& estimate, const std::vector<Point2>& truth) {
  Point2 low = estimate.front(), high = low;
  for (const std::vector<Point2>* points : {&estimate, &truth}) {
    for (const Point2& point : *points) {
      low = {std::min(low.x, point.x), std::min(low.y, point.y)};
      high = {std::max(high.x, point.x), std::max(high.y, point.y)};
    }
  }
  const Point2 centre{0.5 * (low.x + high.x), 0.5 * (low.y + high.y)};
  const double border = 1.0 + 2.0 * kEmptyBorder;
  double width = (high.x - low.x) * border, height = (high.y - low.y) * border;
  const double span = std::max({width, height, kSmallestSpan});
  if (!std::isfinite(span)) throw Error("cannot draw a trajectory without bounds");

  // The picture takes the path's proportions as far as its shortest side allows.
  const auto side = [&](double extent, int margins) {
    return std::clamp(static_cast<int>(std::lround(extent / span * (kLongestSide - margins))) + margins,
                      kShortestSide, kLongestSide);
  };
  PlotView view;
  view.picture = {side(width, kMarginLeft + kMarginRight), side(height, kMarginTop + kMarginBottom)};
  view.left = kMarginLeft;
  view.top = kMarginTop;
  view.width = view.picture.width - kMarginLeft - kMarginRight;
  view.height = view.picture.height - kMarginTop - kMarginBottom;
  width = std::max(width, 1e-3 * span);
  height = std::max(height, 1e-3 * span);
  view.pixels_per_metre = std::min({view.width / width, view.height / height, view.width / kSmallestSpan});
  view.low = {centre.x - 0.5 * view.width / view.pixels_per_metre,
              centre.y - 0.5 * view.height / view.pixels_per_metre};
  return view;
}

void draw_grid(PlotCanvas& canvas, const PlotView& view, PlotPlane plane) {
  const double step = round_step(kLabelDistance / view.pixels_per_metre);
  const auto lines = [&](double low, double high, const auto& draw) {
    const double first = std::ceil(low / step) * step;
    for (int i = 0; i < kMostGridLines && first + i * step <= high; ++i) {
      const double value = std::abs(first + i * step) < 1e-6 * step ? 0.0 : first + i * step;
      draw(value, fmt::format("{:.6g}", value));
    }
  };
  lines(view.low.x, view.high().x, [&](double x, const std::string& label) {
    const double column = view.to_picture({x, view.low.y}).x;
    canvas.line({column, view.top}, {column, view.bottom()}, 1.0, kGrid);
    canvas.text(label, {column, view.bottom() + 26}, 12, Anchor::centre, kFaintInk);
  });
  lines(view.low.y, view.high().y, [&](double y, const std::string& label) {
    const double row = view.to_picture({view.low.x, y}).y;
    canvas.line({view.left, row}, {view.right(), row}, 1.0, kGrid);
    canvas.text(label, {view.left - 12, row + 6}, 12, Anchor::right, kFaintInk);
  });
  canvas.box({view.left, view.top}, {view.right(), view.bottom()}, kFrame, 1.0);
  canvas.text("x (m)", {view.left + 0.5 * view.width, view.bottom() + 60}, 14, Anchor::centre, kInk);
  canvas.text(plane == PlotPlane::xz ? "z (m)" : "y (m)", {view.left - 12, view.top - 12}, 14, Anchor::right,
              kInk);
}

void draw_path(PlotCanvas& canvas, const PlotView& view, const std::vector<Point2>& points, double width,
               const Bgr& colour) {
  std::vector<Point2> polyline;
  polyline.reserve(points.size());
  for (const Point2& point : points) polyline.push_back(view.to_picture(point));
  canvas.polyline(std::move(polyline), width, colour);
}

// Start is a disc and end a square; white rims keep them apart from the lines below.
void draw_marker(PlotCanvas& canvas, Point2 centre, bool is_start) {
  constexpr double kRadius = 9.0, kRim = 3.0;
  if (is_start) {
    canvas.disc(centre, kRadius + kRim, kPaper);
    canvas.disc(centre, kRadius, kStartColour);
    return;
  }
  for (const auto& [half, colour] :
       {std::pair(kRadius + kRim - 1.0, kPaper), std::pair(kRadius - 1.0, kEndColour)}) {
    canvas.box({centre.x - half, centre.y - half}, {centre.x + half, centre.y + half}, colour);
  }
}

// One row of samples and names that ends at the frame's right edge, above it.
void draw_legend(PlotCanvas& canvas, const PlotView& view, const std::string& estimate_name, bool has_truth) {
  constexpr double kHeight = 14, kSample = 44, kSpace = 10, kGap = 30;
  const double row = view.top - 18;
  double x = view.right();
  const auto name_entry = [&](const std::string& name, double sample) {
    x -= text_width(name, kHeight);
    canvas.text(name, {x, row}, kHeight, Anchor::left, kInk);
    x -= kSpace + sample;
  };
  const auto line_entry = [&](const std::string& name, const Bgr& colour, double width) {
    name_entry(name, kSample);
    canvas.line({x, row - 6}, {x + kSample, row - 6}, width, colour);
    x -= kGap;
  };
  for (const bool is_start : {false, true}) {
    name_entry(is_start ? "start" : "end", 20);
    draw_marker(canvas, {x + 10, row - 6}, is_start);
    x -= kGap;
  }
  line_entry(estimate_name, kEstimateColour, 3.0);
  if (has_truth) line_entry("ground truth", kTruthColour, 6.0);
}

}  // namespace

PlotCanvas draw_trajectories(const Trajectory& estimate, const Trajectory& ground_truth,
                             const TrajectoryPlotOptions& options) {
  if (estimate.empty()) throw Error("cannot draw a trajectory without a pose");
  const std::vector<Point2> path = project(estimate, options.plane);
  const std::vector<Point2> truth = project(ground_truth, options.plane);
  const PlotView view = make_view(path, truth);
  PlotCanvas canvas(view.picture.width, view.picture.height);

  draw_grid(canvas, view, options.plane);
  draw_path(canvas, view, truth, 6.0, kTruthColour);
  draw_path(canvas, view, path, 3.0, kEstimateColour);
  draw_marker(canvas, view.to_picture(path.back()), false);
  draw_marker(canvas, view.to_picture(path.front()), true);
  draw_legend(canvas, view, options.estimate_name, !truth.empty());
  const std::string subtitle =
      options.subtitle.empty()
          ? fmt::format("top view, {}, {:.1f} m", counted(estimate.size(), "pose"), path_length(estimate))
          : options.subtitle;
  // A long name gets smaller letters.
  const double room = view.picture.width - kMarginLeft - kMarginRight, kTitle = 22.0;
  const double title_height = kTitle * std::min(1.0, room / std::max(1.0, text_width(options.title, kTitle)));
  canvas.text(options.title, {kMarginLeft, 48}, title_height, Anchor::left, kInk, true);
  canvas.text(subtitle, {kMarginLeft, 80}, 14, Anchor::left, kFaintInk);
  return canvas;
}

}  // namespace penumbra::slam
