#include "slam/evaluation/dense_evaluation.h"

#include <Eigen/SVD>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "nn/base/parallel.h"
#include "nn/base/quantile.h"

namespace penumbra::slam {

namespace {

constexpr double kNear = 0.03;   // metres: a truth voxel with a voxel of the map so near is there
constexpr double kGhost = 0.03;  // metres
constexpr double kFarthestNeighbour = 0.10;
constexpr int kStep = 2;  // pixels between those of the truth that are taken

struct Nearest {
  double distance = 0.0;  // metres
  const Voxel* voxel = nullptr;
};

// The voxel whose place is nearest, and how far that is; where none is nearer than `most`, none and `most`.
Nearest nearest_to(const VoxelGrid& grid, const Eigen::Vector3f& place, double most) {
  const auto size = static_cast<float>(grid.size());
  const int reach = static_cast<int>(std::ceil(most / grid.size()));
  Nearest nearest{most, nullptr};
  for (int shell = 0; shell <= reach; ++shell) {
    // All that is in this shell is at least this far away.
    if ((shell - 1) * grid.size() > nearest.distance) break;
    for (int z = -shell; z <= shell; ++z) {
      for (int y = -shell; y <= shell; ++y) {
        const bool inner = std::abs(z) < shell && std::abs(y) < shell;
        for (int x = -shell; x <= shell; x += inner && shell > 0 ? 2 * shell : 1) {
          const Eigen::Vector3f there =
              place +
              size * Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
          const Voxel* voxel = grid.find(there);
          if (voxel == nullptr) continue;
          const double distance = (voxel->place - place).norm();
          if (distance < nearest.distance) nearest = {distance, voxel};
        }
      }
    }
  }
  return nearest;
}

}  // namespace

Similarity align_poses(const Trajectory& truth, const Trajectory& estimate) {
  require_paired(truth, estimate, 1);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < truth.size(); ++i)
    sum += truth[i].T_wc.rotation * estimate[i].T_wc.rotation.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Similarity alignment;
  alignment.rotation = svd.matrixU() * svd.matrixV().transpose();
  if (alignment.rotation.determinant() < 0.0) {
    const Eigen::Vector3d mirror(1.0, 1.0, -1.0);
    alignment.rotation = svd.matrixU() * mirror.asDiagonal() * svd.matrixV().transpose();
  }
  for (std::size_t i = 0; i < truth.size(); ++i) {
    alignment.translation += truth[i].T_wc.translation - alignment.rotation * estimate[i].T_wc.translation;
  }
  alignment.translation /= static_cast<double>(truth.size());
  return alignment;
}

void DenseTruth::add(const StereoCamera& camera, const SE3& T_wc, const FloatImage& depth,
                     const ByteImage& kinds, const FloatImage& sensed, double farthest) {
  ++frames_;
  for (int v = 0; v < depth.height(); v += kStep) {
    for (int u = 0; u < depth.width(); u += kStep) {
      const double z = depth.at(u, v);
      if (!(z > 0.0) || z > farthest) continue;
      SurfaceSample point;
      point.place = (T_wc * camera.back_project(u, v, z)).cast<float>();
      point.colour = {static_cast<float>(z), 0.0F, 0.0F};
      const double measured = sensed.at(u, v);
      point.class_id = measured > 0.0 && measured <= farthest ? 1 : 0;
      const std::uint8_t kind = kinds.at(u, v);
      (kind == kStands ? standing_ : kind == kPerson ? people_ : things_).add(point, frames_);
    }
  }
}

DenseScore DenseTruth::score(const DenseCloud& map, const Similarity& truth_from_map) const {
  DenseScore score;
  score.voxels = static_cast<int>(map.places.size());
  score.truth_voxels = static_cast<int>(standing_.voxels().size());
  VoxelGrid moved(standing_.size());
  std::vector<double> errors(map.places.size()), distances(map.places.size());
  std::vector<std::uint8_t> ghost(map.places.size(), kStands);  // what is left of
  std::vector<Eigen::Vector3f> places(map.places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector3f p(map.places[i].data());
    places[i] = (truth_from_map * p.cast<double>()).cast<float>();
    moved.add({.place = places[i], .weight = 1.0F, .colour = Eigen::Vector3f::Zero()}, 1);
  }
  parallel_for(places.size(), 1024, [&](std::size_t i) {
    const Nearest standing = nearest_to(standing_, places[i], kFarthestNeighbour);
    errors[i] = standing.distance;
    distances[i] = standing.voxel == nullptr ? 0.0 : standing.voxel->colour[0];
    if (errors[i] <= 2.0 * kGhost) return;
    const auto was_in = [&](const VoxelGrid& grid) {
      return nearest_to(grid, places[i], kGhost).voxel != nullptr;
    };
    ghost[i] = was_in(people_) ? kPerson : was_in(things_) ? kThingMoves : kStands;
  });
  std::vector<double> at_three;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (distances[i] > 2.5 && distances[i] < 3.5) at_three.push_back(errors[i]);
  }
  const std::vector<Voxel>& truth = standing_.voxels();
  std::atomic<std::size_t> measured{0}, found{0};
  parallel_for(truth.size(), 1024, [&](std::size_t i) {
    const Voxel& voxel = truth[i];
    if (voxel.class_id != 1) return;
    ++measured;
    if (nearest_to(moved, voxel.place, kNear).voxel != nullptr) ++found;
  });
  const auto share = [](double part, double whole) { return whole > 0.0 ? part / whole : 0.0; };
  score.completeness = share(static_cast<double>(found), static_cast<double>(measured));
  const auto share_of = [&](std::uint8_t kind) {
    return share(static_cast<double>(std::count(ghost.begin(), ghost.end(), kind)), score.voxels);
  };
  score.people = share_of(kPerson);
  score.ghosts = score.people + share_of(kThingMoves);
  score.median_error_at_3m = quantile_of(std::move(at_three), 0.5);
  score.p95_error = quantile_of(errors, 0.95);
  score.median_error = quantile_of(std::move(errors), 0.5);
  return score;
}

}  // namespace penumbra::slam
