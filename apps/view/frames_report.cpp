#include "apps/view/frames_report.h"

#include <cmath>

#include "apps/common/rounded.h"

namespace penumbra::apps {

namespace {

nlohmann::json histogram(const slam::MismatchFilterReport& report) {
  if (report.bins.empty()) return nullptr;
  std::vector<int> kept, removed;
  for (const auto& bin : report.bins) {
    kept.push_back(bin.kept);
    removed.push_back(bin.removed);
  }
  const auto& first = report.bins.front();
  return {{"from", to_a_millionth(first.from)},
          {"width", to_a_millionth(first.to - first.from)},
          {"kept", kept},
          {"removed", removed}};
}

}  // namespace

const char* name_of(slam::TrackingState state) {
  switch (state) {
    case slam::TrackingState::initialising:
      return "initialising";
    case slam::TrackingState::tracking:
      return "tracking";
    case slam::TrackingState::occluded:
      return "occluded";
    case slam::TrackingState::lost:
      break;
  }
  return "lost";
}

nlohmann::json frames_report(const slam::Recorder& record) {
  nlohmann::json json;
  for (const char* key : {"index", "timestamp", "state", "ms", "features", "stereo_features",
                          "movable_features", "covered_share", "matches", "inliers", "keyframe", "filter"}) {
    json[key] = nlohmann::json::array();
  }
  for (const slam::FrameResult& r : record.results()) {
    json["index"].push_back(r.index);
    json["timestamp"].push_back(r.timestamp);
    json["state"].push_back(name_of(r.tracking.state));
    json["ms"].push_back(to_a_millionth(r.milliseconds));
    json["features"].push_back(r.features);
    json["stereo_features"].push_back(r.stereo_features);
    json["movable_features"].push_back(r.movable_features);
    json["covered_share"].push_back(to_a_millionth(r.covered_share));
    json["matches"].push_back(r.tracking.frame_matches);
    json["inliers"].push_back(r.tracking.map_inliers);
    json["keyframe"].push_back(r.keyframe);
    json["filter"].push_back(histogram(r.tracking.filter));
  }
  return json;
}

}  // namespace penumbra::apps
