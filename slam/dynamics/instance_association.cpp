#include "slam/dynamics/instance_association.h"

#include <algorithm>

#include "slam/dynamics/movable.h"

namespace penumbra::slam {

namespace {

constexpr double kSameMask = 0.7;  // overlap from which on two masks are one thing's whatever their depths

// Whether detectors take them for each other; "" may be anything.
bool are_alike(const std::string& a, const std::string& b) {
  return a.empty() || a == b || (is_vehicle_class(a) && is_vehicle_class(b));
}

// How the frame showed the track; nullptr where it did not.
const InstanceView* view_in(const Track& track, int frame) {
  const auto at = std::ranges::find(track.views, frame, &InstanceView::frame);
  return at == track.views.end() ? nullptr : &*at;
}

bool depths_meet(const InstanceView& a, const InstanceView& b) {
  return a.nearest <= b.farthest && b.nearest <= a.farthest;
}

// How far apart things at this depth may be that are one.
double nearest_metres(const InstanceView& view, const InstanceTrackerSettings& settings) {
  return settings.nearest_metres + 0.05 * view.centre.z();
}

// How well the track fits; 0: not at all.
double fit_of(const Instance& instance, const InstanceView& view, const Track& track,
              const FrameHistory& history, const InstanceTrackerSettings& settings) {
  const std::string& name = track.instance.class_name;
  if (!name.empty() && is_movable_class(name) != is_movable_class(instance.class_name)) return 0.0;
  const bool same_class = name.empty() || name == instance.class_name;
  const double nearest = nearest_metres(view, settings);
  double fit = 0.0;
  if (const InstanceView* known = view_in(track, view.frame)) {
    const double shared = overlap(*known, view);
    if (shared < kSameMask && !depths_meet(*known, view)) return 0.0;
    const double apart = (known->centre - view.centre).norm();
    if (shared >= settings.least_overlap) {
      fit = 1.0 + shared;
    } else if (same_class && containment(*known, view) >= settings.least_containment) {
      fit = 0.5 + shared;
    } else if (same_class && apart < nearest) {
      fit = 0.5 / (1.0 + apart);
    }
  } else if (same_class && !track.moves()) {
    // Out of sight, behind something, or not found for a while: where it stood when it was last seen.
    const FrameRecord* then = history.find(track.views.back().frame);
    const FrameRecord* now = history.find(view.frame);
    if (then == nullptr || now == nullptr) return 0.0;
    const double apart =
        (now->T_co * (then->T_co.inverse() * track.views.back().centre) - view.centre).norm();
    if (apart < nearest) fit = 0.5 / (1.0 + apart);
  }
  return fit > 0.0 && same_class ? fit + 0.5 : fit;
}

}  // namespace

int owner_of(const Instance& instance, const InstanceView& view, const std::vector<Track>& tracks,
             const std::vector<char>& taken, const FrameHistory& history,
             const InstanceTrackerSettings& settings) {
  int best = -1;
  double best_fit = 0.0;
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    if (taken[t] != 0) continue;
    const double fit = fit_of(instance, view, tracks[t], history, settings);
    if (fit <= best_fit) continue;
    best_fit = fit;
    best = static_cast<int>(t);
  }
  return best;
}

const Track* whole_of(const Instance& part, const InstanceView& view, const std::vector<Track>& tracks,
                      const InstanceTrackerSettings& settings) {
  if (!settings.check_motion || !is_movable_class(part.class_name)) return nullptr;
  for (const Track& track : tracks) {
    const InstanceView* whole = view_in(track, view.frame);
    if (whole == nullptr || !track.is_known_to_move() || !depths_meet(*whole, view)) continue;
    if (whole->area() < view.area()) continue;
    const bool is_near = (whole->centre - view.centre).norm() < nearest_metres(view, settings);
    if ((is_near && are_alike(track.instance.class_name, part.class_name)) ||
        containment(*whole, view) >= settings.least_containment)
      return &track;
  }
  return nullptr;
}

}  // namespace penumbra::slam
