#include "slam/dynamics/instance_view.h"

#include <algorithm>
#include <cmath>

#include "nn/base/quantile.h"
#include "nn/image/resize.h"
#include "slam/frontend/features/nearest_descriptor.h"

namespace penumbra::slam {

namespace {

constexpr double kNearestDepth = 0.5;    // metres; closer things cannot be carried
constexpr double kLargestScaling = 2.0;  // from frame to frame
constexpr int kFewestForShift = 4;       // matches that may correct the mask's place
constexpr double kDepthSlack = 0.05;     // of the depth, for stereo noise; plus half a metre

Eigen::Vector3d position(const StereoCamera& camera, const FeatureView& features, int i) {
  const FeaturePixel pixel = features.pixel(i);
  return camera.back_project(pixel.u, pixel.v, features.depth(i));
}

// Depths that belong to the object, from the bulk of its points: a mask's rim also shows what is behind.
bool set_place(const StereoCamera& camera, const FeatureView& features, const InstanceViewSettings& settings,
               InstanceView& view) {
  std::vector<double> depths;
  for (const int i : view.features) {
    if (features.has_stereo(i)) depths.push_back(features.depth(i));
  }
  if (static_cast<int>(depths.size()) < settings.fewest_stereo) return false;
  std::sort(depths.begin(), depths.end());
  const double middle = quantile_of_sorted(depths, 0.5), slack = 0.5 + kDepthSlack * middle;
  view.nearest = std::max(quantile_of_sorted(depths, 0.1), 0.5 * middle) - slack;
  view.farthest = std::min(quantile_of_sorted(depths, 0.9), 2.0 * middle) + slack;
  std::vector<double> x, y, z;
  for (const int i : view.features) {
    const double depth = features.depth(i);
    if (!features.has_stereo(i) || depth < view.nearest || depth > view.farthest) continue;
    const Eigen::Vector3d p = position(camera, features, i);
    x.push_back(p.x());
    y.push_back(p.y());
    z.push_back(p.z());
  }
  view.centre = {quantile_of(std::move(x), 0.5), quantile_of(std::move(y), 0.5),
                 quantile_of(std::move(z), 0.5)};
  return true;
}

// Features on the mask whose depth, where they have one, is the object's.
void find_features(const FeatureView& features, int margin, bool check_depth, InstanceView& view) {
  view.features.clear();
  for (int i = 0; i < features.size(); ++i) {
    const Keypoint k = features.keypoint(i);
    // A feature of a higher level looks at a larger patch.
    if (!touches(view, k.u, k.v, margin > 0 ? margin + k.level : 0)) continue;
    const double depth = features.depth(i);
    if (check_depth && features.has_stereo(i) && (depth < view.nearest || depth > view.farthest)) continue;
    view.features.push_back(i);
  }
}

// Moves `view`'s mask: `from` becomes `to`, scaled; false where too little of it is left in the image.
bool warp_mask(const StereoCamera& camera, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
               double scale, const InstanceView& view, InstanceView& warped) {
  const Eigen::Vector2d corner =
      to + scale * (Eigen::Vector2d(view.region.x - 0.5, view.region.y - 0.5) - from);
  const Rect whole{static_cast<int>(std::lround(corner.x() + 0.5)),
                   static_cast<int>(std::lround(corner.y() + 0.5)),
                   std::max(1, static_cast<int>(std::lround(scale * view.region.width))),
                   std::max(1, static_cast<int>(std::lround(scale * view.region.height)))};
  const Rect inside = intersection(whole, {0, 0, camera.width, camera.height});
  if (inside.area() < 16) return false;
  const ByteImage mask = resize_nearest<std::uint8_t>(view.mask, {whole.width, whole.height});
  warped.region = inside;
  warped.mask =
      ByteImage::copy_of(mask.region({inside.x - whole.x, inside.y - whole.y, inside.width, inside.height}));
  return true;
}

struct Guess {
  int feature = 0;
  Eigen::Vector2d pixel;
  double depth = -1.0;  // predicted; negative: unknown
};

// The nearest descriptor around each guess; of several that choose one feature the best keeps it.
std::vector<std::pair<int, int>> match(const std::vector<Guess>& guesses, const FeatureView& from,
                                       const FeatureView& to, const InstanceViewSettings& settings) {
  std::vector<std::pair<int, int>> best_of(static_cast<std::size_t>(to.size()), {-1, 0});
  for (const Guess& guess : guesses) {
    NearestDescriptor nearest = NearestDescriptor::within(settings.max_distance + 1);
    const int level = from.level(guess.feature);
    to.measured().grid.visit_near(
        static_cast<float>(guess.pixel.x()), static_cast<float>(guess.pixel.y()), settings.search_radius,
        [&](int j) {
          if (std::abs(to.level(j) - level) > 1) return;
          if (guess.depth > 0.0 && to.has_stereo(j) &&
              std::abs(to.depth(j) - guess.depth) > 1.0 + 0.15 * guess.depth)
            return;
          nearest.offer(j, hamming_distance(from.descriptor(guess.feature), to.descriptor(j)));
        });
    if (nearest.index < 0) continue;
    auto& [source, kept] = best_of[static_cast<std::size_t>(nearest.index)];
    if (source >= 0 && kept <= nearest.distance) continue;
    source = guess.feature;
    kept = nearest.distance;
  }
  std::vector<std::pair<int, int>> matches;
  for (int j = 0; j < to.size(); ++j) {
    if (best_of[static_cast<std::size_t>(j)].first >= 0)
      matches.emplace_back(best_of[static_cast<std::size_t>(j)].first, j);
  }
  return matches;
}

int shared_area(const InstanceView& a, const InstanceView& b) {
  const Rect common = intersection(a.region, b.region);
  int shared = 0;
  for (int y = common.y; y < common.y + common.height; ++y) {
    const std::uint8_t* in_a = a.mask.row(y - a.region.y) + common.x - a.region.x;
    const std::uint8_t* in_b = b.mask.row(y - b.region.y) + common.x - b.region.x;
    for (int x = 0; x < common.width; ++x) shared += (in_a[x] & in_b[x]) != 0;
  }
  return shared;
}

}  // namespace

bool touches(const InstanceView& view, float x, float y, int margin) {
  const int column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
  for (const int dy : {-margin, 0, margin}) {
    for (const int dx : {-margin, 0, margin}) {
      if (view.contains(column + dx, row + dy)) return true;
    }
  }
  return false;
}

std::optional<InstanceView> make_view(const StereoCamera& camera, int frame, const Instance& instance,
                                      const FeatureView& features, const InstanceViewSettings& settings) {
  InstanceView view;
  view.frame = frame;
  view.region = instance.region;
  view.mask = instance.mask;
  find_features(features, 0, /*check_depth=*/false, view);
  if (!set_place(camera, features, settings, view)) return std::nullopt;
  find_features(features, settings.margin, /*check_depth=*/true, view);
  return view;
}

std::optional<CarriedView> carry_view(const StereoCamera& camera, const InstanceView& view,
                                      const FeatureView& from, const FeatureView& to, int frame,
                                      const SE3& T_to_from, const Eigen::Vector3d& displacement,
                                      const InstanceViewSettings& settings) {
  const Eigen::Vector3d moved = T_to_from * (view.centre + displacement);
  if (moved.z() < kNearestDepth || view.centre.z() < kNearestDepth) return std::nullopt;
  const double scale = view.centre.z() / moved.z();
  if (scale > kLargestScaling || scale < 1.0 / kLargestScaling) return std::nullopt;
  const Eigen::Vector2d old_centre = camera.project(view.centre);
  Eigen::Vector2d new_centre = camera.project(moved);

  std::vector<Guess> guesses;
  for (const int i : view.features) {
    const FeaturePixel pixel = from.pixel(i);
    Guess guess{i, new_centre + scale * (Eigen::Vector2d(pixel.u, pixel.v) - old_centre), -1.0};
    if (from.has_stereo(i)) {
      const Eigen::Vector3d p = T_to_from * (position(camera, from, i) + displacement);
      if (p.z() < kNearestDepth) continue;
      guess.pixel = camera.project(p);
      guess.depth = p.z();
    }
    guesses.push_back(guess);
  }
  CarriedView carried;
  carried.matches = match(guesses, from, to, settings);

  std::vector<double> du, dv, dz;
  std::size_t g = 0;
  std::vector<std::pair<int, int>> by_source = carried.matches;
  std::sort(by_source.begin(), by_source.end());
  for (const auto& [i, j] : by_source) {
    while (guesses[g].feature != i) ++g;  // both ascend
    du.push_back(to.pixel(j).u - guesses[g].pixel.x());
    dv.push_back(to.pixel(j).v - guesses[g].pixel.y());
    if (from.has_stereo(i) && to.has_stereo(j)) dz.push_back(to.depth(j) - guesses[g].depth);
  }
  double depth_shift = 0.0;
  if (static_cast<int>(du.size()) >= kFewestForShift) {
    new_centre += Eigen::Vector2d(quantile_of(std::move(du), 0.5), quantile_of(std::move(dv), 0.5));
  }
  if (static_cast<int>(dz.size()) >= kFewestForShift) depth_shift = quantile_of(std::move(dz), 0.5);

  InstanceView& warped = carried.view;
  warped.frame = frame;
  // The mask grows as the measured depth says: a wrong velocity would let it grow from frame to frame.
  const double depth = std::max(kNearestDepth, moved.z() + depth_shift);
  const double size = std::clamp(view.centre.z() / depth, 1.0 / kLargestScaling, kLargestScaling);
  if (!warp_mask(camera, old_centre, new_centre, size, view, warped)) return std::nullopt;
  warped.centre = camera.back_project(new_centre.x(), new_centre.y(), depth);
  warped.nearest = view.nearest + depth - view.centre.z();
  warped.farthest = view.farthest + depth - view.centre.z();
  find_features(to, settings.margin, /*check_depth=*/true, warped);
  std::erase_if(carried.matches, [&](const std::pair<int, int>& m) {
    return !std::binary_search(warped.features.begin(), warped.features.end(), m.second);
  });
  return carried;
}

double overlap(const InstanceView& a, const InstanceView& b) {
  const int shared = shared_area(a, b);
  return shared / static_cast<double>(std::max(1, a.area() + b.area() - shared));
}

double containment(const InstanceView& a, const InstanceView& b) {
  return shared_area(a, b) / static_cast<double>(std::max(1, std::min(a.area(), b.area())));
}

}  // namespace penumbra::slam
