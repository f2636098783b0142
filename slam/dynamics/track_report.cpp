#include "slam/dynamics/track_report.h"

#include <utility>

namespace penumbra::slam {

namespace {

// Calls visit(track, view) for what `frame` shows.
template <typename Visit>
void visit_views(const std::vector<Track>& tracks, int frame, Visit&& visit) {
  for (const Track& track : tracks) {
    for (const InstanceView& view : track.views) {
      if (view.frame == frame) visit(track, view);
    }
  }
}

}  // namespace

std::vector<SeenObject> seen_objects(const std::vector<Track>& tracks, int frame, const MotionBelief& belief,
                                     int first_number) {
  std::vector<SeenObject> objects;
  visit_views(tracks, frame, [&](const Track& track, const InstanceView& view) {
    objects.push_back({first_number + track.instance.id, track.instance.class_name, view.centre, view.region,
                       belief.stands(track.instance)});
  });
  return objects;
}

std::vector<KeyframeObjects> tell_keyframe_objects(FrameHistory& history, const std::vector<Track>& tracks,
                                                   const MotionBelief& belief, int first_number) {
  std::vector<KeyframeObjects> changed;
  for (FrameRecord& record : history.records()) {
    if (record.keyframe == nullptr) continue;
    std::vector<SeenObject> seen = seen_objects(tracks, record.index, belief, first_number);
    if (record.told == seen) continue;
    record.told = std::move(seen);
    changed.push_back({record.keyframe, record.told});
  }
  return changed;
}

std::vector<InstanceSighting> sightings_in(const std::vector<Track>& tracks, int frame) {
  std::vector<InstanceSighting> seen;
  visit_views(tracks, frame, [&](const Track& track, const InstanceView& view) {
    seen.push_back({track.instance.id, view.region, view.mask, view.centre, track.instance.state(),
                    track.instance.visible_share});
  });
  return seen;
}

double moving_share(const std::vector<Track>& tracks, int width, int height, bool proven) {
  ByteImage covered;
  for (const Track& track : tracks) {
    if (!track.active || !track.moves() || (proven && !track.instance.measured)) continue;
    if (covered.empty()) covered = ByteImage::filled(width, height, 0);
    const InstanceView& view = track.views.back();
    for (int y = 0; y < view.region.height; ++y) {
      const std::uint8_t* mask = view.mask.row(y);
      std::uint8_t* row = covered.row(view.region.y + y) + view.region.x;
      for (int x = 0; x < view.region.width; ++x) row[x] |= mask[x];
    }
  }
  return covered.empty() ? 0.0 : count_pixels(covered) / static_cast<double>(covered.elements());
}

}  // namespace penumbra::slam
