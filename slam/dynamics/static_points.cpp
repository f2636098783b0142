#include "slam/dynamics/static_points.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace penumbra::slam {

namespace {

constexpr int kCell = 16;  // pixels

}  // namespace

StaticPoints::StaticPoints(const StereoCamera& camera, std::vector<double> scales,
                           const StaticPointSettings& settings, const FrameHistory& history)
    : camera_(camera), scales_(std::move(scales)), settings_(settings), history_(history) {}

void StaticPoints::before_pose(const FrameBeforePose& frame, std::vector<char>& movable) {
  count_ = {};
  if (settings_.constraint.mode == StaticPointMode::off) return;
  // Where nothing can be given back nothing more is taken.
  if (earlier_view() != nullptr) add_companions(FeatureView(*frame.features, movable), movable);
}

// From what can move to what is within reach of it, and once more from there: an arm's length and what is in
// the hand.
void StaticPoints::add_companions(const FeatureView& features, std::vector<char>& movable) {
  const auto point = [&](int i) {
    const FeaturePixel p = features.pixel(i);
    return camera_.back_project(p.u, p.v, features.depth(i));
  };
  grown_ = movable;
  front_.clear();
  for (int i = 0; i < features.size(); ++i) {
    if (features.is_movable(i) && features.has_stereo(i)) front_.push_back(i);
  }
  if (front_.empty()) return;
  std::size_t from = 0;
  for (int round = 0; round < 2; ++round) {
    const std::size_t end = front_.size();
    for (; from < end; ++from) {
      const int i = front_[from];
      const Eigen::Vector3d p = point(i);
      const FeaturePixel pixel = features.pixel(i);
      // What is nearer by as much is seen at a larger angle.
      const double radius = camera_.fx * settings_.reach / std::max(settings_.reach, p.z() - settings_.reach);
      features.measured().grid.visit_near(pixel.u, pixel.v, static_cast<float>(radius), [&](int j) {
        char& mark = grown_[static_cast<std::size_t>(j)];
        if (mark != 0 || !features.has_stereo(j) || (point(j) - p).norm() > settings_.reach) return;
        mark = 1;
        front_.push_back(j);
      });
    }
  }
  int others = 0;
  for (int i = 0; i < features.size(); ++i)
    others += features.has_stereo(i) && grown_[static_cast<std::size_t>(i)] == 0;
  if (others >= settings_.fewest_others) movable.swap(grown_);
}

// The newest one that is old enough, of those that were located.
const FrameRecord* StaticPoints::earlier_view() const {
  const FrameRecord& now = history_.newest();
  const auto& records = history_.records();
  for (auto at = records.rbegin() + 1; at != records.rend(); ++at) {
    const double age = seconds_between(*at, now);
    if (age > settings_.longest_age) return nullptr;
    // A frame between them that was lost does no harm: its pose is a step on the way, whatever it is.
    if (age >= settings_.least_age && at->observed && at->reliable) return &*at;
  }
  return nullptr;
}

// Cells of the image that hold features which are left out, and those beside them.
void StaticPoints::find_marked_places(const FeatureView& features) {
  const int columns = camera_.width / kCell + 1, rows = camera_.height / kCell + 1;
  marked_places_.assign(static_cast<std::size_t>(columns * rows), 0);
  for (int i = 0; i < features.size(); ++i) {
    if (!features.is_movable(i)) continue;
    const FeaturePixel p = features.pixel(i);
    const int x = static_cast<int>(p.u) / kCell, y = static_cast<int>(p.v) / kCell;
    for (int v = std::max(0, y - 1); v <= std::min(rows - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(columns - 1, x + 1); ++u)
        marked_places_[static_cast<std::size_t>(v * columns + u)] = 1;
    }
  }
}

bool StaticPoints::is_near_marked(const Eigen::Vector2d& pixel) const {
  const int columns = camera_.width / kCell + 1;
  const int x = static_cast<int>(pixel.x()) / kCell, y = static_cast<int>(pixel.y()) / kCell;
  return marked_places_[static_cast<std::size_t>(y * columns + x)] != 0;
}

// Looks for the earlier view's points where they would be if they stood still, among the features that are
// left out.
void StaticPoints::judge(const FrameRecord& earlier, const SE3& T_c_k, const FeatureView& now,
                         const std::vector<char>& movable) {
  const FeatureView before(*earlier.features, earlier.pixels, {});
  projections_.clear();
  for (int i = 0; i < before.size(); ++i) {
    if (!before.has_stereo(i)) continue;
    const FeaturePixel pixel = before.pixel(i);
    const Eigen::Vector3d p = T_c_k * camera_.back_project(pixel.u, pixel.v, before.depth(i));
    if (!(p.z() > 0.0)) continue;
    const Eigen::Vector2d at = camera_.project(p);
    if (!camera_.in_image(at) || !is_near_marked(at)) continue;
    projections_.push_back({static_cast<float>(at.x()), static_cast<float>(at.y()), -1.0F, before.level(i),
                            before.measured().keypoint(i).angle, &before.descriptor(i), i});
  }
  taken_.resize(movable.size());
  std::transform(movable.begin(), movable.end(), taken_.begin(), [](char moves) { return moves == 0; });
  FrameMatcherSettings search;
  search.radius = static_cast<float>(settings_.search_radius);
  search.check_rotation = false;
  const DualConstraint constraint(camera_, T_c_k, settings_.constraint);
  const auto measured = [&](const FeatureView& view, int i) {
    const FeaturePixel pixel = view.pixel(i);
    return MeasuredPoint{{pixel.u, pixel.v}, view.depth(i), scales_[static_cast<std::size_t>(view.level(i))]};
  };
  for (const Match& match : match_projections(projections_, now, taken_, scales_, search)) {
    const std::optional<PointDifference> difference =
        constraint.compare(measured(before, match.source), measured(now, match.feature));
    if (!difference) continue;
    ++count_.compared;
    verdicts_[static_cast<std::size_t>(match.feature)] =
        constraint.moves(*difference) ? Verdict::moves : Verdict::stands;
  }
}

// Whether it stands, by itself and by the judged features around it at a like depth. One that moves may have
// found a match by chance, its neighbours have not; one that found none stands if all around it does.
bool StaticPoints::stands(const FeatureView& features, int feature) const {
  const Verdict own = verdicts_[static_cast<std::size_t>(feature)];
  if (own == Verdict::moves) return false;
  const FeaturePixel at = features.pixel(feature);
  const float depth = features.depth(feature);
  int judged = 0, standing = 0;
  features.measured().grid.visit_near(at.u, at.v, static_cast<float>(settings_.neighbourhood), [&](int i) {
    const Verdict verdict = verdicts_[static_cast<std::size_t>(i)];
    const float other = features.depth(i);
    if (depth > 0.0F && other > 0.0F && std::abs(other - depth) > settings_.like_depth * depth) return;
    judged += verdict != Verdict::unknown;
    standing += verdict == Verdict::stands;
  });
  const double needed =
      own == Verdict::stands ? settings_.agreeing_share : settings_.agreeing_share_unmatched;
  return judged >= settings_.fewest_neighbours && standing >= needed * judged;
}

bool StaticPoints::between_poses(const FrameBetweenPoses& frame, std::vector<char>& movable) {
  if (settings_.constraint.mode == StaticPointMode::off) return false;
  count_.left_out =
      static_cast<int>(std::count_if(movable.begin(), movable.end(), [](char m) { return m != 0; }));
  if (count_.left_out == 0) return false;
  const FrameRecord* earlier = earlier_view();
  if (earlier == nullptr) return false;
  const FrameRecord& now = history_.newest();
  const SE3 T_co = frame.T_step * history_.before_newest().T_co;  // by the first pose
  const FeatureView marked(*now.features, *frame.pixels, movable);
  find_marked_places(marked);
  verdicts_.assign(movable.size(), Verdict::unknown);
  judge(*earlier, T_co * earlier->T_co.inverse(), FeatureView(*now.features, *frame.pixels, {}), movable);
  back_.clear();
  for (int i = 0; i < marked.size(); ++i) {
    if (marked.is_movable(i) && stands(marked, i)) back_.push_back(i);
  }
  for (const int i : back_) {
    movable[static_cast<std::size_t>(i)] = 0;
    ++count_.given_back;
  }
  return count_.given_back > 0;
}

}  // namespace penumbra::slam
