// The floor of a cloud of points, found by what a floor is: a large plane that the cameras stand above, under
// which there is nothing.
//
//   n . p + d = 0,   n of unit length, upwards: n . p + d is the height of p
//
// RANSAC over triples of voxels; a plane counts where its normal lies within 45 degrees of the mean upward
// axis of the cameras, all cameras above it, and at most 1 % of the voxels below it by more than twice
// `on_floor`. The one with the most voxels within `on_floor` wins and is refined by least squares on them.
// Cost: 500 tries, each on at most 5000 voxels.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "slam/geometry/se3.h"

namespace penumbra::slam {

struct FloorPlane {
  Eigen::Vector3d normal = -Eigen::Vector3d::UnitY();
  double offset = 0.0;  // metres

  double height(const Eigen::Vector3d& p) const { return normal.dot(p) + offset; }
};

// `cameras`: T_wc. `on_floor`: metres. Nothing where no plane is that, or fewer than 2 % of the points lie on
// it.
std::optional<FloorPlane> find_floor(std::span<const Eigen::Vector3f> points, std::span<const SE3> cameras,
                                     double on_floor = 0.025);

}  // namespace penumbra::slam
