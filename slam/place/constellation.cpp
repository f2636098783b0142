#include "slam/place/constellation.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace penumbra::slam {

namespace {

using Agreeing = std::pair<std::size_t, std::size_t>;  // object of the image, object of the place

double tolerance(const SeenObject& object, const ConstellationSettings& settings) {
  return settings.tolerance_metres + settings.tolerance_share * object.position.norm();
}

bool shows(const Constellation& constellation, int number) {
  return std::any_of(constellation.begin(), constellation.end(),
                     [&](const SeenObject& object) { return object.number == number; });
}

// What takes part in the comparison: stands somewhere, and is not in `other`, too.
Constellation standing(const Constellation& constellation, const Constellation& other) {
  Constellation standing;
  for (const SeenObject& object : constellation) {
    if (object.stands && object.position.allFinite() && !shows(other, object.number))
      standing.push_back(object);
  }
  return standing;
}

// Pairs that agree, one to one, where both are in the image's frame and the place is moved by `shift`.
std::vector<Agreeing> agreeing_pairs(const Constellation& image, const Constellation& place,
                                     const Eigen::Vector3d& shift, const ConstellationSettings& settings) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> near;
  for (std::size_t a = 0; a < image.size(); ++a) {
    for (std::size_t b = 0; b < place.size(); ++b) {
      if (image[a].class_name != place[b].class_name) continue;
      const double apart = (image[a].position - place[b].position - shift).norm();
      if (apart <= tolerance(image[a], settings)) near.emplace_back(apart, a, b);
    }
  }
  std::sort(near.begin(), near.end());
  std::vector<char> image_taken(image.size(), 0), place_taken(place.size(), 0);
  std::vector<Agreeing> pairs;
  for (const auto& [apart, a, b] : near) {
    if (image_taken[a] != 0 || place_taken[b] != 0) continue;
    image_taken[a] = place_taken[b] = 1;
    pairs.emplace_back(a, b);
  }
  return pairs;
}

// The most that agree under another motion that takes an object of the place onto one of the image.
int best_rival(const Constellation& image, const Constellation& place,
               const ConstellationSettings& settings) {
  int best = 0;
  for (const SeenObject& a : image) {
    for (const SeenObject& b : place) {
      const Eigen::Vector3d shift = a.position - b.position;
      if (a.class_name != b.class_name || shift.norm() <= 2.0 * tolerance(a, settings)) continue;
      best = std::max(best, static_cast<int>(agreeing_pairs(image, place, shift, settings).size()));
    }
  }
  return best;
}

// Root mean square distance from the best line through the objects, in the ground plane.
double spread_of(const Constellation& image, const std::vector<Agreeing>& pairs) {
  if (pairs.size() < 3) return 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& [a, b] : pairs) mean += Eigen::Vector2d(image[a].position.x(), image[a].position.z());
  mean /= static_cast<double>(pairs.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const auto& [a, b] : pairs) {
    const Eigen::Vector2d p = Eigen::Vector2d(image[a].position.x(), image[a].position.z()) - mean;
    scatter += p * p.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(scatter / static_cast<double>(pairs.size()),
                                                              Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
}

// Whether the image should show what is at `position`, and found nothing there, moving or not.
bool is_missing(const StereoCamera& camera, const Constellation& image, const Eigen::Vector3d& position,
                const ConstellationSettings& settings) {
  if (!(position.z() >= settings.nearest && position.z() <= settings.farthest)) return false;
  const Eigen::Vector2d pixel = camera.project(position);
  if (!(pixel.x() >= settings.rim && pixel.x() <= camera.width - settings.rim && pixel.y() >= 0.0 &&
        pixel.y() <= camera.height)) {
    return false;
  }
  const int u = static_cast<int>(pixel.x()), v = static_cast<int>(pixel.y());
  return std::none_of(image.begin(), image.end(), [&](const SeenObject& object) {
    const bool hides = object.region.contains(u, v) && object.position.z() < position.z();
    return hides || (object.position - position).norm() <= 2.0 * tolerance(object, settings);
  });
}

}  // namespace

Constellation constellation_around(const KeyFrame& keyframe, int neighbours) {
  Constellation around = keyframe.objects;
  struct Seen {
    SeenObject newest;
    int frame = -1, times = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  };
  std::map<int, Seen> elsewhere;  // by number
  for (int n = 0; n < neighbours && n < static_cast<int>(keyframe.covisibles.size()); ++n) {
    const KeyFrame& neighbour = *keyframe.covisibles[static_cast<std::size_t>(n)].keyframe;
    const SE3 T_here_there = keyframe.T_cw * neighbour.T_cw.inverse();
    for (const SeenObject& object : neighbour.objects) {
      if (shows(keyframe.objects, object.number)) continue;
      Seen& seen = elsewhere[object.number];
      seen.sum += T_here_there * object.position;
      ++seen.times;
      if (neighbour.frame_index > seen.frame) {
        seen.newest = object;
        seen.frame = neighbour.frame_index;
      }
    }
  }
  for (auto& [number, seen] : elsewhere) {
    seen.newest.position = seen.sum / seen.times;
    seen.newest.region = {};
    around.push_back(std::move(seen.newest));
  }
  std::sort(around.begin(), around.end(),
            [](const SeenObject& a, const SeenObject& b) { return a.number < b.number; });
  return around;
}

int count_standing(const Constellation& constellation) {
  return static_cast<int>(std::count_if(constellation.begin(), constellation.end(),
                                        [](const SeenObject& object) { return object.stands; }));
}

ConstellationAgreement compare_constellations(const StereoCamera& camera, const Constellation& image,
                                              const Constellation& place, const SE3& T_image_place,
                                              const ConstellationSettings& settings) {
  const Constellation here = standing(image, place);
  Constellation there = standing(place, image);
  for (SeenObject& object : there) object.position = T_image_place * object.position;
  const std::vector<Agreeing> pairs = agreeing_pairs(here, there, Eigen::Vector3d::Zero(), settings);
  ConstellationAgreement agreement;
  agreement.agreeing = static_cast<int>(pairs.size());
  agreement.rival = best_rival(here, there, settings);
  agreement.spread = spread_of(here, pairs);
  for (std::size_t b = 0; b < there.size(); ++b) {
    const bool agrees =
        std::any_of(pairs.begin(), pairs.end(), [&](const Agreeing& pair) { return pair.second == b; });
    // What only the place's neighbours show may be hidden from here as it is from there.
    if (agrees || there[b].region.empty()) continue;
    agreement.contradicted += is_missing(camera, image, there[b].position, settings);
  }
  return agreement;
}

bool supports_place(const ConstellationAgreement& agreement, const ConstellationSettings& settings) {
  return settings.enabled && agreement.agreeing >= settings.fewest_agreeing &&
         agreement.agreeing >= agreement.rival + settings.fewest_more_than_rival &&
         agreement.spread >= settings.least_spread &&
         agreement.contradicted <= settings.most_contradicted * agreement.agreeing;
}

}  // namespace penumbra::slam
