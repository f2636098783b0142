#include "apps/brain/brain_plots.h"

#include <algorithm>
#include <cmath>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "slam/brain/position/place_cells.h"
#include "slam/brain/position/position_model.h"

namespace penumbra::apps {

namespace {

constexpr int kWidth = 1100, kHeight = 640;
constexpr double kLeft = 90.0, kRight = 30.0, kTop = 80.0, kBottom = 70.0;
constexpr Bgr kWay{150, 150, 150}, kNode{178, 114, 0}, kRecalled{0, 94, 213}, kSettled{115, 158, 0};

// Metres to pixels, the same for both axes.
struct MapView {
  double scale = 1.0, x0 = 0.0, y0 = 0.0;
  // x of the plane points up on the picture, y to the left.
  Point2 operator()(const slam::brain::PlanePose& pose) const {
    return {x0 - scale * pose.y, y0 - scale * pose.x};
  }
};

MapView view_of(const slam::brain::CognitiveMap& map, const Size& size) {
  double low_x = 1e300, high_x = -1e300, low_y = 1e300, high_y = -1e300;
  for (const slam::brain::Node& node : map.nodes()) {
    low_x = std::min(low_x, node.pose.x);
    high_x = std::max(high_x, node.pose.x);
    low_y = std::min(low_y, node.pose.y);
    high_y = std::max(high_y, node.pose.y);
  }
  const double width = size.width - kLeft - kRight, height = size.height - kTop - kBottom;
  MapView view;
  view.scale = std::min(width / std::max(high_y - low_y, 1.0), height / std::max(high_x - low_x, 1.0));
  view.x0 = kLeft + 0.5 * width + view.scale * 0.5 * (low_y + high_y);
  view.y0 = kTop + 0.5 * height + view.scale * 0.5 * (low_x + high_x);
  return view;
}

std::vector<double> errors_of(const slam::TrajectoryPair& pair) {
  std::vector<double> errors;
  for (std::size_t i = 0; i < pair.reference.size(); ++i)
    errors.push_back((pair.reference[i].T_wc.translation - pair.estimate[i].T_wc.translation).norm());
  return errors;
}

}  // namespace

slam::PlotCanvas draw_cognitive_map(const slam::brain::CognitiveMap& map) {
  slam::PlotCanvas canvas(kWidth, kWidth);
  canvas.text("Cognitive map", {kLeft, 36.0}, 18, slam::Anchor::left, slam::kInk, true);
  const auto recalled = std::count_if(map.links().begin(), map.links().end(),
                                      [](const slam::brain::Link& link) { return link.recalled; });
  const MapView to_picture = view_of(map, canvas.size());
  canvas.text(fmt::format("{}, {}; red: {} by which a place was recalled", counted(map.size(), "node"),
                          counted(map.links().size(), "link"), recalled),
              {kLeft, 60.0}, 12, slam::Anchor::left, slam::kFaintInk);
  for (const bool drawn_last : {false, true}) {
    for (const slam::brain::Link& link : map.links()) {
      if (link.recalled != drawn_last) continue;
      canvas.line(to_picture(map.node(link.from).pose), to_picture(map.node(link.to).pose), 2.0,
                  link.recalled ? kRecalled : kWay);
    }
  }
  for (const slam::brain::Node& node : map.nodes()) canvas.disc(to_picture(node.pose), 2.2, kNode);
  // A bar of a round length tells the scale.
  const double metres = slam::round_step(80.0 / to_picture.scale), y = kWidth - 30.0;
  canvas.line({kLeft, y}, {kLeft + metres * to_picture.scale, y}, 2.0, slam::kInk);
  canvas.text(fmt::format("{:g} m", metres), {kLeft, y - 8.0}, 12, slam::Anchor::left, slam::kInk);
  return canvas;
}

slam::PlotCanvas draw_error_over_time(const slam::TrajectoryPair& believed,
                                      const slam::TrajectoryPair& settled,
                                      const std::vector<double>& recall_times) {
  if (believed.reference.size() < 2 || settled.reference.size() < 2)
    throw Error("no error over time without two true poses");
  const std::vector<double> at_the_time = errors_of(believed), by_the_map = errors_of(settled);
  const double begin = believed.reference.front().timestamp;
  const double span = std::max(believed.reference.back().timestamp - begin, 1e-9);
  double most = 0.1;
  for (const std::vector<double>* errors : {&at_the_time, &by_the_map})
    most = std::max(most, *std::max_element(errors->begin(), errors->end()));
  slam::PlotCanvas canvas(kWidth, kHeight);
  const double width = kWidth - kLeft - kRight, height = kHeight - kTop - kBottom, bottom = kHeight - kBottom;
  const auto at = [&](double time, double error) {
    return Point2{kLeft + width * (time - begin) / span, bottom - height * error / most};
  };
  canvas.text("Distance from the true position", {kLeft, 36.0}, 18, slam::Anchor::left, slam::kInk, true);
  canvas.text(
      "from a common start; blue: as believed at the time; green: by the settled map; red: a place was "
      "recalled",
      {kLeft, 60.0}, 12, slam::Anchor::left, slam::kFaintInk);
  const double step = slam::round_step(most / 6.0);
  for (double error = 0.0; error <= most; error += step) {
    canvas.line(at(begin, error), at(begin + span, error), 1.0, slam::kGrid);
    canvas.text(fmt::format("{:g}", error), {kLeft - 10.0, at(begin, error).y + 5.0}, 12, slam::Anchor::right,
                slam::kFaintInk);
  }
  const double seconds = slam::round_step(span / 8.0);
  for (double time = 0.0; time <= span; time += seconds) {
    canvas.text(fmt::format("{:g}", time), {at(begin + time, 0.0).x, bottom + 22.0}, 12, slam::Anchor::centre,
                slam::kFaintInk);
  }
  canvas.text("seconds", {kLeft + 0.5 * width, bottom + 50.0}, 13, slam::Anchor::centre, slam::kInk);
  canvas.text("metres", {kLeft - 10.0, kTop - 8.0}, 13, slam::Anchor::right, slam::kInk);
  for (const double time : recall_times) canvas.line(at(time, 0.0), at(time, 0.03 * most), 1.0, kRecalled);
  const auto draw = [&](const slam::Trajectory& times, const std::vector<double>& errors, const Bgr& colour) {
    std::vector<Point2> points;
    for (std::size_t i = 0; i < errors.size(); ++i) points.push_back(at(times[i].timestamp, errors[i]));
    canvas.polyline(std::move(points), 2.0, colour);
  };
  draw(believed.reference, at_the_time, kNode);
  draw(settled.reference, by_the_map, kSettled);
  return canvas;
}

ByteImage draw_place_activity(const slam::brain::CognitiveMap& map,
                              const slam::brain::BrainRecorder& record) {
  constexpr int kMost = 400;
  std::vector<const slam::brain::BrainResult*> keyframes;
  for (const slam::brain::BrainResult& result : record.results()) {
    if (result.keyframe) keyframes.push_back(&result);
  }
  const int columns = std::min(kMost, static_cast<int>(keyframes.size())), rows = std::min(kMost, map.size());
  if (columns == 0 || rows == 0) throw Error("no keyframes, no activity of place cells");
  const auto width = static_cast<float>(slam::brain::PlaceCellSettings().width);
  slam::brain::PositionModel position(slam::brain::standard_grid_code());
  const auto activity_at = [&](const slam::brain::PlanePose& place) {
    const std::span<const float> activity = position.activity_at({place.x, place.y});
    return Eigen::Map<const Eigen::VectorXf>(activity.data(), static_cast<Eigen::Index>(activity.size()))
        .eval();
  };
  std::vector<Eigen::VectorXf> cells;
  for (int y = 0; y < rows; ++y)
    cells.push_back(
        activity_at(map.node(static_cast<int>(static_cast<std::int64_t>(y) * map.size() / rows)).pose));
  ByteImage picture(columns, rows, 1);
  for (int x = 0; x < columns; ++x) {
    const slam::brain::BrainResult& now =
        *keyframes[static_cast<std::size_t>(x) * keyframes.size() / static_cast<std::size_t>(columns)];
    const Eigen::VectorXf here = activity_at(map.node(now.anchor).pose * now.since_anchor);
    const float variance = width * width * static_cast<float>(here.size());
    for (int y = 0; y < rows; ++y) {
      const float p = std::exp(-0.5F * (here - cells[static_cast<std::size_t>(y)]).squaredNorm() / variance);
      *(picture.row(y) + x) = static_cast<std::uint8_t>(std::lround(255.0F * (1.0F - p)));
    }
  }
  return picture;
}

}  // namespace penumbra::apps
