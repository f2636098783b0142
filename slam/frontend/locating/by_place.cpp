#include "slam/frontend/locating/by_place.h"

#include "slam/frontend/locating/local_map_search.h"

namespace penumbra::slam {

namespace {

// Where the camera was last, best first: this run's newest keyframes; before there are any, the reference and
// its neighbours in a map that was loaded.
std::vector<KeyFrame*> keyframes_near(const LocatingInput& in) {
  std::vector<KeyFrame*> near;
  const std::vector<KeyFrame*>& all = in.map.keyframes();
  for (auto k = all.rbegin(); k != all.rend() && (*k)->id >= in.first_own_keyframe; ++k) {
    if (static_cast<int>(near.size()) == in.settings.recognition.last_keyframes) return near;
    near.push_back(*k);
  }
  if (!near.empty() || in.reference == nullptr) return near;
  near.push_back(in.reference);
  for (const Covisible& c : in.reference->covisibles) near.push_back(c.keyframe);
  return near;
}

}  // namespace

void locate_by_place(const LocatingInput& in, Hypothesis& found) {
  found.begin(in.frame, in.reference);
  {
    const auto scope = in.timer.measure("recognise");
    const FeatureView measured(*in.frame.features, in.frame.movable);
    std::optional<VerifiedPlace> place = recognise_image(in.map, in.index, keyframes_near(in), measured,
                                                         static_cast<std::uint64_t>(in.frame.index),
                                                         in.settings.recognition, in.frame.objects);
    if (!place) return;
    found.T_cw = place->T_cw;
    found.points = std::move(place->points);
    found.reference = place->keyframe;
  }
  search_local_map(in, std::nullopt, found);
}

}  // namespace penumbra::slam
