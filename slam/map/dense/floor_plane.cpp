#include "slam/map/dense/floor_plane.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "nn/base/counter_random.h"

namespace penumbra::slam {

namespace {

constexpr int kTries = 500;
constexpr std::size_t kMostPoints = 5000;
constexpr double kBelow = 2.0;                         // of what lies on the floor
constexpr double kMostBelow = 0.01, kFewestOn = 0.02;  // shares of the points
constexpr double kUpright = 0.7071;                    // cosine

// An evenly spread part of the points.
std::vector<Eigen::Vector3d> sample_of(std::span<const Eigen::Vector3f> points) {
  const std::size_t step = points.size() / kMostPoints + 1;
  std::vector<Eigen::Vector3d> sample;
  for (std::size_t i = 0; i < points.size(); i += step) sample.push_back(points[i].cast<double>());
  return sample;
}

// How many points lie on the plane; 0 where it cannot be the floor.
std::size_t support(const FloorPlane& plane, const std::vector<Eigen::Vector3d>& points,
                    std::span<const SE3> cameras, double on_floor) {
  for (const SE3& camera : cameras) {
    if (plane.height(camera.translation) <= kBelow * on_floor) return 0;
  }
  std::size_t on = 0, below = 0;
  for (const Eigen::Vector3d& p : points) {
    const double height = plane.height(p);
    on += std::abs(height) < on_floor;
    below += height < -kBelow * on_floor;
  }
  return static_cast<double>(below) > kMostBelow * static_cast<double>(points.size()) ? 0 : on;
}

// The plane of least squares through the points that lie within `band` of `plane`.
FloorPlane refined(const FloorPlane& plane, double band, const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  double count = 0.0;
  for (const Eigen::Vector3d& p : points) {
    if (std::abs(plane.height(p)) >= band) continue;
    count += 1.0;
    mean += p;
    scatter += p * p.transpose();
  }
  if (count < 3.0) return plane;
  mean /= count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter / count - mean * mean.transpose());
  Eigen::Vector3d normal = solver.eigenvectors().col(0);
  if (normal.dot(plane.normal) < 0.0) normal = -normal;
  return {normal, -normal.dot(mean)};
}

}  // namespace

std::optional<FloorPlane> find_floor(std::span<const Eigen::Vector3f> cloud, std::span<const SE3> cameras,
                                     double on_floor) {
  const std::vector<Eigen::Vector3d> points = sample_of(cloud);
  if (points.size() < 3 || cameras.empty()) return std::nullopt;
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  for (const SE3& camera : cameras) up -= camera.rotation.col(1);  // y is down
  up.normalize();
  std::uint64_t drawn = 0;
  FloorPlane best;
  std::size_t most = static_cast<std::size_t>(kFewestOn * static_cast<double>(points.size()));
  bool found = false;
  for (int i = 0; i < kTries; ++i) {
    const auto pick = [&] { return points[counter_random(1, drawn++) % points.size()]; };
    const Eigen::Vector3d a = pick(), b = pick(), c = pick();
    Eigen::Vector3d normal = (b - a).cross(c - a);
    if (normal.squaredNorm() < 1e-12) continue;
    normal.normalize();
    if (normal.dot(up) < 0.0) normal = -normal;
    if (normal.dot(up) < kUpright) continue;
    const FloorPlane plane{normal, -normal.dot(a)};
    const std::size_t on = support(plane, points, cameras, on_floor);
    if (on <= most) continue;
    most = on;
    best = plane;
    found = true;
  }
  if (!found) return std::nullopt;
  // Narrower each time: the feet of what stands on the floor are no part of it.
  for (const double share : {1.0, 0.6, 0.4}) best = refined(best, share * on_floor, points);
  return best;
}

}  // namespace penumbra::slam
