#include "apps/view/frames_report.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "apps/common/rounded.h"
#include "nn/base/file_in_the_making.h"

namespace penumbra::apps {

namespace {

nlohmann::json histogram(const slam::KeptFrames& run, const slam::KeptFrame& frame) {
  if (frame.bars == 0) return nullptr;
  std::vector<int> kept, removed;
  for (const slam::FilterBar& bar : run.bars(frame)) {
    kept.push_back(bar.kept);
    removed.push_back(bar.removed);
  }
  return {{"from", to_a_millionth(frame.bar_from)},
          {"width", to_a_millionth(frame.bar_width)},
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

void write_frames_report(const std::filesystem::path& path, const slam::KeptFrames& run) {
  nn::TextInTheMaking file(path);
  const char* before = "{";
  const auto column = [&](const char* name, const auto& value_of) {
    file.add(fmt::format("{}\"{}\":[", std::exchange(before, ","), name));
    const char* between = "";
    for (const slam::KeptFrame& frame : run.frames())
      file.add(std::exchange(between, ",") + nlohmann::json(value_of(frame)).dump());
    file.add("]");
  };
  using Frame = const slam::KeptFrame&;
  column("covered_share", [](Frame f) { return to_a_millionth(f.covered_share); });
  column("features", [](Frame f) { return f.features; });
  column("filter", [&](Frame f) { return histogram(run, f); });
  column("index", [](Frame f) { return f.index; });
  column("inliers", [](Frame f) { return f.map_inliers; });
  column("keyframe", [](Frame f) { return f.keyframe; });
  column("matches", [](Frame f) { return f.frame_matches; });
  column("movable_features", [](Frame f) { return f.movable_features; });
  column("ms", [](Frame f) { return to_a_millionth(f.milliseconds); });
  column("state", [](Frame f) { return name_of(f.state); });
  column("stereo_features", [](Frame f) { return f.stereo_features; });
  column("timestamp", [](Frame f) { return f.timestamp; });
  file.add("}\n");
  file.commit();
}

}  // namespace penumbra::apps
