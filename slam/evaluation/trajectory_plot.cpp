#include "slam/evaluation/trajectory_plot.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

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

const cv::Scalar kFrame(180, 180, 180), kTruthColour(150, 150, 150), kEstimateColour(178, 114, 0),
    kStartColour(115, 158, 0), kEndColour(0, 94, 213);  // BGR

std::vector<cv::Point2d> project(const Trajectory& trajectory, PlotPlane plane) {
  std::vector<cv::Point2d> points;
  points.reserve(trajectory.size());
  for (const TimedPose& pose : trajectory) {
    const Eigen::Vector3d& p = pose.T_wc.translation;
    if (!p.allFinite()) throw Error("cannot draw a trajectory with a position that is not finite");
    points.emplace_back(p.x(), plane == PlotPlane::xz ? p.z() : p.y());
  }
  return points;
}

// The part of the world that is shown and where: metres to final pixels.
struct PlotView {
  cv::Size picture;
  cv::Rect2d frame;  // the plot's frame, final pixels
  cv::Point2d low;   // world position of the frame's lower left corner, metres
  double pixels_per_metre = 1.0;

  cv::Point2d to_picture(const cv::Point2d& world) const {
    return {frame.x + (world.x - low.x) * pixels_per_metre,
            frame.y + frame.height - (world.y - low.y) * pixels_per_metre};
  }
  cv::Point2d high() const {
    return {low.x + frame.width / pixels_per_metre, low.y + frame.height / pixels_per_metre};
  }
};

PlotView make_view(const std::vector<cv::Point2d>& estimate, const std::vector<cv::Point2d>& truth) {
  cv::Point2d low = estimate.front(), high = low;
  for (const std::vector<cv::Point2d>* points : {&estimate, &truth}) {
    for (const cv::Point2d& point : *points) {
      low = {std::min(low.x, point.x), std::min(low.y, point.y)};
      high = {std::max(high.x, point.x), std::max(high.y, point.y)};
    }
  }
  const cv::Point2d centre = 0.5 * (low + high);
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
  view.frame = cv::Rect2d(kMarginLeft, kMarginTop, view.picture.width - kMarginLeft - kMarginRight,
                          view.picture.height - kMarginTop - kMarginBottom);
  width = std::max(width, 1e-3 * span);
  height = std::max(height, 1e-3 * span);
  view.pixels_per_metre =
      std::min({view.frame.width / width, view.frame.height / height, view.frame.width / kSmallestSpan});
  view.low = {centre.x - 0.5 * view.frame.width / view.pixels_per_metre,
              centre.y - 0.5 * view.frame.height / view.pixels_per_metre};
  return view;
}

void draw_grid(cv::Mat& canvas, const PlotView& view, PlotPlane plane) {
  const cv::Rect2d& frame = view.frame;
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
    cv::line(canvas, scaled({column, frame.y}), scaled({column, frame.br().y}), kGrid, 2, cv::LINE_AA);
    draw_text(canvas, label, {column, frame.br().y + 26}, 12, Anchor::centre, kFaintInk);
  });
  lines(view.low.y, view.high().y, [&](double y, const std::string& label) {
    const double row = view.to_picture({view.low.x, y}).y;
    cv::line(canvas, scaled({frame.x, row}), scaled({frame.br().x, row}), kGrid, 2, cv::LINE_AA);
    draw_text(canvas, label, {frame.x - 12, row + 6}, 12, Anchor::right, kFaintInk);
  });
  cv::rectangle(canvas, scaled(frame.tl()), scaled(frame.br()), kFrame, 2);
  draw_text(canvas, "x (m)", {frame.x + 0.5 * frame.width, frame.br().y + 60}, 14, Anchor::centre, kInk);
  draw_text(canvas, plane == PlotPlane::xz ? "z (m)" : "y (m)", {frame.x - 12, frame.y - 12}, 14,
            Anchor::right, kInk);
}

void draw_path(cv::Mat& canvas, const PlotView& view, const std::vector<cv::Point2d>& points,
               const cv::Scalar& colour, int thickness) {
  constexpr int kFractionBits = 4;
  std::vector<cv::Point> polyline;
  polyline.reserve(points.size());
  for (const cv::Point2d& point : points) {
    polyline.emplace_back(scaled(view.to_picture(point) * (1 << kFractionBits)));
  }
  cv::polylines(canvas, polyline, false, colour, thickness, cv::LINE_AA, kFractionBits);
}

// Start is a disc and end a square; white rims keep them apart from the lines below.
void draw_marker(cv::Mat& canvas, cv::Point2d position, bool is_start) {
  constexpr int kRadius = 9 * kSupersampling, kRim = 3 * kSupersampling;
  const cv::Point centre = scaled(position);
  if (is_start) {
    cv::circle(canvas, centre, kRadius + kRim, kPaper, cv::FILLED, cv::LINE_AA);
    cv::circle(canvas, centre, kRadius, kStartColour, cv::FILLED, cv::LINE_AA);
    return;
  }
  for (const auto& [half, colour] :
       {std::pair(kRadius + kRim - 2, kPaper), std::pair(kRadius - 2, kEndColour)}) {
    cv::rectangle(canvas, centre - cv::Point(half, half), centre + cv::Point(half, half), colour, cv::FILLED);
  }
}

// One row of samples and names that ends at the frame's right edge, above it.
void draw_legend(cv::Mat& canvas, const PlotView& view, const std::string& estimate_name, bool has_truth) {
  constexpr double kHeight = 14, kSample = 44, kSpace = 10, kGap = 30;
  const double row = view.frame.y - 18;
  double x = view.frame.br().x;
  const auto name_entry = [&](const std::string& name, double sample) {
    x -= text_width(name, kHeight);
    draw_text(canvas, name, {x, row}, kHeight, Anchor::left, kInk);
    x -= kSpace + sample;
  };
  const auto line_entry = [&](const std::string& name, const cv::Scalar& colour, int thickness) {
    name_entry(name, kSample);
    cv::line(canvas, scaled({x, row - 6}), scaled({x + kSample, row - 6}), colour, thickness, cv::LINE_AA);
    x -= kGap;
  };
  for (const bool is_start : {false, true}) {
    name_entry(is_start ? "start" : "end", 20);
    draw_marker(canvas, {x + 10, row - 6}, is_start);
    x -= kGap;
  }
  line_entry(estimate_name, kEstimateColour, 3 * kSupersampling);
  if (has_truth) line_entry("ground truth", kTruthColour, 6 * kSupersampling);
}

}  // namespace

cv::Mat draw_trajectories(const Trajectory& estimate, const Trajectory& ground_truth,
                          const TrajectoryPlotOptions& options) {
  if (estimate.empty()) throw Error("cannot draw a trajectory without a pose");
  const std::vector<cv::Point2d> path = project(estimate, options.plane);
  const std::vector<cv::Point2d> truth = project(ground_truth, options.plane);
  const PlotView view = make_view(path, truth);
  cv::Mat canvas(view.picture * kSupersampling, CV_8UC3, kPaper);

  draw_grid(canvas, view, options.plane);
  draw_path(canvas, view, truth, kTruthColour, 6 * kSupersampling);
  draw_path(canvas, view, path, kEstimateColour, 3 * kSupersampling);
  draw_marker(canvas, view.to_picture(path.back()), false);
  draw_marker(canvas, view.to_picture(path.front()), true);
  draw_legend(canvas, view, options.estimate_name, !truth.empty());
  const std::string subtitle = options.subtitle.empty() ? fmt::format("top view, {} poses, {:.1f} m",
                                                                      estimate.size(), path_length(estimate))
                                                        : options.subtitle;
  draw_text(canvas, options.title, {kMarginLeft, 48}, 22, Anchor::left, kInk, true);
  draw_text(canvas, subtitle, {kMarginLeft, 80}, 14, Anchor::left, kFaintInk);

  cv::Mat picture;
  cv::resize(canvas, picture, view.picture, 0.0, 0.0, cv::INTER_AREA);
  return picture;
}

}  // namespace penumbra::slam
