#include "slam/brain/position/oscillators.h"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "slam/brain/position/random_stream.h"

namespace penumbra::slam::brain {

namespace {

constexpr double kFullCircle = 2.0 * std::numbers::pi;
constexpr double kBoundaryLength = 0.1;  // b, metres

}  // namespace

Oscillators::Oscillators(const Eigen::Matrix2Xd& directions, const Eigen::VectorXd& start, double wavelength)
    : wavelength_(wavelength),
      waves_(directions * (kFullCircle / wavelength)),
      inverse_((waves_ * waves_.transpose()).inverse() * waves_),
      start_(start),
      phases_(start) {}

Eigen::VectorXd Oscillators::random_start(int directions, std::uint64_t seed) {
  RandomStream random(seed, 4);
  Eigen::VectorXd start(directions);
  for (double& phase : start) phase = random.uniform(0.0, kFullCircle);
  return start;
}

void Oscillators::advance(const HeadDirectionRing& ring, double speed, double seconds) {
  const double way = kFullCircle / wavelength_ * speed * seconds;
  for (int j = 0; j < phases_.size(); ++j) phases_[j] += way * ring.response(j);
}

void Oscillators::place(const Eigen::Vector2d& position) {
  phases_ = start_;
  phases_.noalias() += waves_.transpose() * position;
}

Eigen::Vector2d Oscillators::position() const {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  for (int j = 0; j < phases_.size(); ++j) position += inverse_.col(j) * (phases_[j] - start_[j]);
  return position;
}

void Oscillators::output(std::span<float> chi) const {
  const std::size_t n = chi.size() / 2;
  for (std::size_t j = 0; j < n; ++j) {
    const double phase = phases_[static_cast<Eigen::Index>(j)];
    chi[j] = static_cast<float>(std::cos(phase));
    chi[n + j] = static_cast<float>(std::sin(phase));
  }
}

double boundary_factor(double wall) { return 1.0 - std::exp(-wall / kBoundaryLength); }

void apply_boundary_factor(double factor, std::span<float> chi) {
  for (float& output : chi) {
    if (output > 0.0F) output *= static_cast<float>(factor);
  }
}

}  // namespace penumbra::slam::brain
