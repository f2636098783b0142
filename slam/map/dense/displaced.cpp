#include "slam/map/dense/displaced.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "nn/base/parallel.h"

namespace penumbra::slam {

namespace {

constexpr std::ptrdiff_t kFewestTold = 20;  // places
constexpr double kContradiction = 0.5;      // share of those that are seen through
constexpr int kContradictingViews = 2;
constexpr std::size_t kMostAsked = 64;  // views
constexpr int kMostPlaces = 400;        // of a thing
constexpr double kNearest = 0.1;        // metres before a camera

// Where its pixels are in the world.
std::vector<Eigen::Vector3d> places_of(const PosedView& from, const Rect& region, const ByteImage& mask,
                                       double farthest) {
  const DenseView& view = *from.view;
  const int step = view.step;
  std::vector<Eigen::Vector3d> places;
  const int apart = std::max(1, static_cast<int>(std::sqrt(region.area() / kMostPlaces)) / step) * step;
  for (int v = region.y; v < region.y + region.height; v += apart) {
    for (int u = region.x; u < region.x + region.width; u += apart) {
      const int x = (u - region.x) * mask.width() / region.width;
      const int y = (v - region.y) * mask.height() / region.height;
      const int column = u / step, row = v / step;
      if (column >= view.depth.width() || row >= view.depth.height() || mask.at(x, y) == 0) continue;
      const auto z = static_cast<double>(view.depth_at(column, row));
      if (z > 0.0 && z <= farthest) places.push_back(from.T_wc * view.camera.back_project(column, row, z));
    }
  }
  return places;
}

// A ball around them.
struct Extent {
  explicit Extent(std::span<const Eigen::Vector3d> places) {
    for (const Eigen::Vector3d& place : places) middle += place;
    middle /= static_cast<double>(places.size());
    for (const Eigen::Vector3d& place : places) radius = std::max(radius, (place - middle).norm());
  }
  // Whether a part of it may be in the picture.
  bool may_be_in(const PosedView& posed) const {
    const StereoCamera& camera = posed.view->camera;
    const Eigen::Vector3d p = posed.T_wc.inverse() * middle;
    if (p.z() + radius < kNearest) return false;
    // The picture's edges are half a pixel outside its outermost pixels.
    const double left = camera.cx + 0.5, right = camera.width - 0.5 - camera.cx;
    const double top = camera.cy + 0.5, bottom = camera.height - 0.5 - camera.cy;
    return left * p.z() + camera.fx * p.x() >= -radius * std::hypot(camera.fx, left) &&
           right * p.z() - camera.fx * p.x() >= -radius * std::hypot(camera.fx, right) &&
           top * p.z() + camera.fy * p.y() >= -radius * std::hypot(camera.fy, top) &&
           bottom * p.z() - camera.fy * p.y() >= -radius * std::hypot(camera.fy, bottom);
  }

  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

enum class Verdict : char { none, mixed, contradicts, confirms };

Verdict verdict_of(std::ptrdiff_t same, std::ptrdiff_t through) {
  const std::ptrdiff_t told = same + through;
  if (told < kFewestTold) return Verdict::none;
  const auto all = static_cast<double>(told);
  if (through >= kFewestTold && static_cast<double>(through) >= kContradiction * all)
    return Verdict::contradicts;
  if (same >= kFewestTold && static_cast<double>(same) > kContradiction * all) return Verdict::confirms;
  return Verdict::mixed;
}

// What a view shows at these places; `nearest`: nearest_depths() of it.
Verdict look_up(const PosedView& posed, const FloatImage& nearest, std::span<const Eigen::Vector3d> places,
                const FusionSettings& settings) {
  const DenseView& view = *posed.view;
  const SE3 T_cw = posed.T_wc.inverse();
  std::ptrdiff_t same = 0, through = 0;
  for (const Eigen::Vector3d& place : places) {
    const Eigen::Vector3d p = T_cw * place;
    if (p.z() < kNearest) continue;
    const int column = static_cast<int>(std::lround(view.camera.fx * p.x() / p.z() + view.camera.cx));
    const int row = static_cast<int>(std::lround(view.camera.fy * p.y() / p.z() + view.camera.cy));
    if (column < 0 || row < 0 || column >= view.depth.width() || row >= view.depth.height()) continue;
    const double z = view.depth_at(column, row);
    if (z <= 0.0) continue;
    const double slack = 3.0 * settings.depth_noise * z * z + 2.0 * settings.voxel;
    same += std::abs(z - p.z()) <= slack;
    through += nearest.at(column, row) > p.z() + slack;
  }
  return verdict_of(same, through);
}

struct Question {
  std::vector<Eigen::Vector3d> places;
  std::vector<std::size_t> asked;  // views
  std::vector<Verdict> verdicts;   // theirs
};

Question question_about(const ShownThing& thing, std::span<const PosedView> views,
                        const FusionSettings& settings) {
  Question question;
  if (thing.mask->empty() || thing.region.empty()) return question;
  question.places = places_of(views[thing.view], thing.region, *thing.mask, settings.farthest);
  if (std::ssize(question.places) < kFewestTold) return question;
  const Extent extent(question.places);
  std::vector<std::size_t>& asked = question.asked;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (i != thing.view && extent.may_be_in(views[i])) asked.push_back(i);
  }
  if (asked.size() > kMostAsked) {
    for (std::size_t i = 0; i < kMostAsked; ++i) asked[i] = asked[i * asked.size() / kMostAsked];
    asked.resize(kMostAsked);
  }
  question.verdicts.resize(asked.size(), Verdict::none);
  return question;
}

bool is_displaced(const Question& question) {
  const auto count = [&](Verdict verdict) {
    return std::count(question.verdicts.begin(), question.verdicts.end(), verdict);
  };
  const auto contradicting = count(Verdict::contradicts), mixed = count(Verdict::mixed);
  return contradicting >= kContradictingViews || (contradicting + mixed > 0 && count(Verdict::confirms) == 0);
}

}  // namespace

std::vector<char> find_displaced(std::span<const ShownThing> things, std::span<const PosedView> views,
                                 const FusionSettings& settings) {
  struct Place {
    std::size_t question, at;  // in its list of views
  };
  std::vector<Question> questions;
  std::vector<std::vector<Place>> of_view(views.size());
  for (const ShownThing& thing : things) {
    questions.push_back(question_about(thing, views, settings));
    const std::vector<std::size_t>& asked = questions.back().asked;
    for (std::size_t at = 0; at < asked.size(); ++at)
      of_view[asked[at]].push_back({questions.size() - 1, at});
  }
  parallel_for(views.size(), 1, [&](std::size_t i) {
    if (of_view[i].empty()) return;
    const FloatImage nearest = nearest_depths(*views[i].view);
    for (const Place& place : of_view[i]) {
      Question& question = questions[place.question];
      question.verdicts[place.at] = look_up(views[i], nearest, question.places, settings);
    }
  });
  std::vector<char> displaced;
  for (const Question& question : questions) displaced.push_back(is_displaced(question) ? 1 : 0);
  return displaced;
}

}  // namespace penumbra::slam
