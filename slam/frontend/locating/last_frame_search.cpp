#include "slam/frontend/locating/last_frame_search.h"

#include "slam/frontend/features/measurement.h"

namespace penumbra::slam {

namespace {

std::vector<Match> without_mismatches(const std::vector<Match>& matches,
                                      const std::vector<MatchedPixels>& pixels,
                                      const MismatchFilterSettings& settings, PairsReport& report) {
  std::vector<char> keep;
  report.frame_matches = static_cast<int>(matches.size());
  report.filter = filter_mismatches(pixels, settings, keep);
  std::vector<Match> kept;
  kept.reserve(matches.size());
  for (std::size_t m = 0; m < matches.size(); ++m) {
    if (keep[m]) kept.push_back(matches[m]);
  }
  return kept;
}

}  // namespace

void search_last_frame(const LocatingInput& in, const SE3& start, float radius,
                       const std::optional<PosePrior>& prior, Hypothesis& found) {
  found.begin(in.frame, in.reference);
  found.T_cw = start;
  const FeatureView measured(*in.frame.features, in.frame.movable);
  FrameMatcherSettings search;
  search.radius = radius;
  std::vector<Projection> projections;
  std::vector<Match> matches;
  {
    const auto scope = in.timer.measure("match_last_frame");
    projections = in.last.project(start);
    matches = match_projections(projections, measured, {}, in.map.scales(), search);
  }
  {
    const auto scope = in.timer.measure("mismatch_filter");
    matches = without_mismatches(matches, in.last.pixels(matches, projections, measured),
                                 in.settings.mismatch_filter, found.report);
  }
  const auto scope = in.timer.measure("pose");
  std::vector<PoseObservation> observations;
  observations.reserve(matches.size());
  for (const Match& match : matches) {
    observations.push_back(
        {*in.last.point(match.source), measurement_of(measured, match.feature, in.map.scales())});
  }
  const PoseEstimate dominant = optimize_pose(in.map.camera(), start, observations, prior);
  const std::optional<SE3> expected = in.motion_known ? std::optional<SE3>(start) : std::nullopt;
  auto [estimate, mover] = in.world_pose({in.map.camera(), observations, dominant, expected}, &found.movable);
  found.report.mover = std::move(mover);
  if (estimate.inliers < in.fewest(in.settings.fewest_frame_inliers)) return;
  found.success = true;
  found.T_cw = estimate.T_cw;
  found.report.frame_inliers = estimate.inliers;
  for (std::size_t m = 0; m < matches.size(); ++m) {
    const auto [last_feature, feature] = std::pair(matches[m].source, matches[m].feature);
    const auto at = static_cast<std::size_t>(feature);
    if (!estimate.inlier[m] || found.movable[at] != 0) continue;
    found.points[at] = in.last.map_point(last_feature);
    if (found.points[at] == nullptr) found.loose.push_back(in.last.loose_point(feature, last_feature));
  }
}

}  // namespace penumbra::slam
