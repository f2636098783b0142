// How one instance looks in one frame: its mask, its place in space, and the features that lie on it.
//
// Carrying a view to another frame: the instance's centre, moved by its own velocity, is projected into the
// other frame, and the mask is shifted and scaled as a thing of that size at the two depths would be,
//
//   u' = c' + (u - c) z / z'        c, c': projected centres, z, z': their depths
//
// Its features are looked for where the same motion takes them; the median of what is left over corrects the
// shift. Features that are new on the mask join where their depth fits.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "nn/image/shapes.h"
#include "slam/dynamics/instance.h"
#include "slam/frontend/features/feature_view.h"
#include "slam/geometry/se3.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

struct InstanceView {
  int frame = 0;
  Rect region;                                       // inside the image
  ByteImage mask;                                    // of `region`
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the stereo points on it, camera's frame, metres
  double nearest = 0.0, farthest = 0.0;              // depths that belong to it
  std::vector<int> features;                         // on it, ascending

  bool contains(int x, int y) const {
    return region.contains(x, y) && mask.at(x - region.x, y - region.y) != 0;
  }
  int area() const { return count_pixels(mask); }
  bool touches_border(const Size& image) const {
    return region.x <= 1 || region.y <= 1 || region.x + region.width >= image.width - 1 ||
           region.y + region.height >= image.height - 1;
  }
};

struct InstanceViewSettings {
  int margin = 3;            // pixels around a mask that still belong to the object, plus one a level
  float search_radius = 12;  // pixels around a feature's predicted place
  int max_distance = 60;     // Hamming
  int fewest_stereo = 3;     // points that give a place in space
};

// Whether the mask has a pixel within `margin` of (x, y): looks at the pixel and at eight around it.
bool touches(const InstanceView& view, float x, float y, int margin);

// The view of a detected instance. Nothing where too few of its features have stereo depth to say where it
// is.
std::optional<InstanceView> make_view(const StereoCamera& camera, int frame, const Instance& instance,
                                      const FeatureView& features, const InstanceViewSettings& settings);

struct CarriedView {
  InstanceView view;
  std::vector<std::pair<int, int>> matches;  // feature of the old frame, feature of the new one
};

// `T_to_from`: from the old camera to the new one; `displacement`: what the object moved by itself meanwhile,
// in the old camera's frame. Nothing where it has left the image.
std::optional<CarriedView> carry_view(const StereoCamera& camera, const InstanceView& view,
                                      const FeatureView& from, const FeatureView& to, int frame,
                                      const SE3& T_to_from, const Eigen::Vector3d& displacement,
                                      const InstanceViewSettings& settings);

// Shared area over joint area, and over the smaller one's.
double overlap(const InstanceView& a, const InstanceView& b);
double containment(const InstanceView& a, const InstanceView& b);

}  // namespace penumbra::slam
