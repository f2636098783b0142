#include "slam/brain/position/lahn.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "nn/base/error.h"
#include "slam/brain/position/random_stream.h"

namespace penumbra::slam::brain {

LahnSettings LahnSettings::of_rule(std::string_view name) {
  LahnSettings settings;
  if (name == "rectified") return settings;
  if (name != "paper") {
    throw UsageError(fmt::format("rule: expected rectified or paper, found '{}'", name));
  }
  settings.bipolar = true;
  settings.threshold = 0.0F;
  settings.forward_rate = settings.lateral_rate = 0.9F;
  settings.lateral = LateralRule::paper;
  return settings;
}

Lahn::Lahn(int inputs, const LahnSettings& settings, std::uint64_t seed)
    : Lahn(Eigen::MatrixXf(settings.cells, inputs), settings) {
  RandomStream random(seed, 5);
  for (float& weight : forward_.reshaped()) {
    weight = static_cast<float>(random.uniform(-settings.first_weight, settings.first_weight));
  }
}

Lahn::Lahn(const Eigen::MatrixXf& forward, const LahnSettings& settings)
    : settings_(settings),
      forward_(forward),
      lateral_(Eigen::MatrixXf::Zero(forward.rows(), forward.rows())),
      activity_(Eigen::VectorXf::Zero(forward.rows())),
      before_(activity_),
      drive_(activity_) {}

float grid_cell_output(float drive, const LahnSettings& settings) {
  const float above = drive - settings.threshold;
  return settings.bipolar ? std::tanh(above) : std::clamp(above, 0.0F, 1.0F);
}

void Lahn::step(std::span<const float> chi) {
  const Eigen::Map<const Eigen::VectorXf> input(chi.data(), static_cast<Eigen::Index>(chi.size()));
  before_.swap(activity_);
  drive_.noalias() = forward_ * input;
  if (settings_.lateral != LateralRule::none) drive_.noalias() += lateral_ * before_;
  for (int i = 0; i < drive_.size(); ++i) activity_[i] = grid_cell_output(drive_[i], settings_);
}

void Lahn::learn(std::span<const float> chi) {
  const Eigen::Map<const Eigen::VectorXf> input(chi.data(), static_cast<Eigen::Index>(chi.size()));
  const float rate = settings_.forward_rate;
  forward_.array().colwise() *= 1.0F - rate * activity_.array().square();
  forward_.noalias() += (rate * activity_) * input.transpose();
  learn_lateral();
  const float largest = std::max(forward_.cwiseAbs().maxCoeff(), lateral_.cwiseAbs().maxCoeff());
  if (largest > settings_.bound) {
    forward_ *= settings_.bound / largest;
    lateral_ *= settings_.bound / largest;
  }
}

void Lahn::learn_lateral() {
  if (settings_.lateral == LateralRule::none) return;
  const float rate = settings_.lateral_rate;
  lateral_.noalias() -= (rate * activity_) * before_.transpose();
  if (settings_.lateral == LateralRule::paper) return;
  lateral_.array() += rate * settings_.sparseness * settings_.sparseness;
  lateral_ = lateral_.cwiseMin(0.0F);
  lateral_.diagonal().setZero();
}

Lahn Lahn::reader() const {
  Lahn read = *this;
  if (read.settings_.lateral == LateralRule::foeldiak) read.settings_.lateral = LateralRule::none;
  return read;
}

void Lahn::forget_activity() { activity_.setZero(); }

}  // namespace penumbra::slam::brain
