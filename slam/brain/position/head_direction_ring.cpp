#include "slam/brain/position/head_direction_ring.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "nn/base/error.h"
#include "slam/brain/position/random_stream.h"

namespace penumbra::slam::brain {

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kTurnTime = 0.5, kTurnDeviation = 1.5;  // of the turns it is trained on: s, rad/s

int checked_directions(int n) {
  if (n <= 0 || n % 6 != 0) {
    throw InputError("head directions", "a positive multiple of 6", fmt::format("{}", n));
  }
  return n;
}

}  // namespace

HeadDirectionRing::HeadDirectionRing(const RingSettings& settings, std::uint64_t seed)
    : weights_(2, checked_directions(settings.directions)) {
  RandomStream random(seed, 2);
  for (auto cell : weights_.colwise()) {
    const double angle = random.uniform(0.0, kTurn);
    cell = Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
}

HeadDirectionRing HeadDirectionRing::trained(const RingSettings& settings, std::uint64_t seed) {
  HeadDirectionRing ring(settings, seed);
  RandomStream random(seed, 3);
  ring.set_heading(random.uniform(0.0, kTurn));
  const double kept = std::exp(-settings.step / kTurnTime);
  double turn_rate = 0.0;
  for (int i = 0; i < settings.steps; ++i) {
    turn_rate = kept * turn_rate + kTurnDeviation * std::sqrt(1.0 - kept * kept) * random.normal();
    ring.turn(turn_rate, settings.step);
    const double done = static_cast<double>(i) / settings.steps;
    ring.learn(settings.first_rate * std::pow(settings.last_rate / settings.first_rate, done),
               settings.first_width * std::pow(settings.last_width / settings.first_width, done),
               settings.last_tension * std::max(0.0, 2.0 * done - 1.0));
  }
  return ring;
}

void HeadDirectionRing::turn(double turn_rate, double seconds) {
  const double c = std::cos(turn_rate * seconds), s = std::sin(turn_rate * seconds);
  state_ = Eigen::Vector2d(c * state_.x() - s * state_.y(), s * state_.x() + c * state_.y()).normalized();
}

void HeadDirectionRing::set_heading(double heading) { state_ = {std::cos(heading), std::sin(heading)}; }

double HeadDirectionRing::heading() const { return std::atan2(state_.y(), state_.x()); }

void HeadDirectionRing::learn(double rate, double width, double tension) {
  const int n = directions();
  int winner = 0;
  for (int i = 1; i < n; ++i) {
    if (response(i) > response(winner)) winner = i;
  }
  before_ = weights_;
  for (int i = 0; i < n; ++i) {
    const int apart = std::abs(i - winner), distance = std::min(apart, n - apart);
    const double share = rate * std::exp(-distance * distance / (2.0 * width * width));
    const Eigen::Vector2d neighbours = before_.col((i + n - 1) % n) + before_.col((i + 1) % n);
    weights_.col(i) =
        (before_.col(i) + share * (state_ - before_.col(i)) + tension * (neighbours - 2.0 * before_.col(i)))
            .normalized();
  }
}

double HeadDirectionRing::unevenness() const {
  const int n = directions();
  std::vector<double> angles;
  for (const auto& cell : weights_.colwise()) angles.push_back(std::atan2(cell.y(), cell.x()));
  std::sort(angles.begin(), angles.end());
  angles.push_back(angles.front() + kTurn);
  double worst = 0.0;
  for (std::size_t i = 0; i + 1 < angles.size(); ++i) {
    worst = std::max(worst, std::abs(angles[i + 1] - angles[i] - kTurn / n));
  }
  return worst;
}

}  // namespace penumbra::slam::brain
