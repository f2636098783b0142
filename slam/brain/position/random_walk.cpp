#include "slam/brain/position/random_walk.h"

#include <cmath>
#include <numbers>

namespace penumbra::slam::brain {

RandomWalk::RandomWalk(const Room& room, const WalkSettings& settings, std::uint64_t seed)
    : room_(&room),
      settings_(settings),
      random_(seed, 1),
      position_(room.start()),
      heading_(random_.uniform(-std::numbers::pi, std::numbers::pi)) {}

void RandomWalk::step() {
  const double kept = std::exp(-settings_.step / settings_.turn_time), before = heading_;
  wandering_ = kept * wandering_ + settings_.turn_deviation * std::sqrt(1.0 - kept * kept) * random_.normal();
  heading_ += wandering_ * settings_.step;
  for (int attempt = 0; attempt < 50; ++attempt) {
    const Eigen::Vector2d next = position_ + settings_.speed * settings_.step *
                                                 Eigen::Vector2d(std::cos(heading_), std::sin(heading_));
    if (room_->contains(next)) {
      position_ = next;
      break;
    }
    heading_ = random_.uniform(-std::numbers::pi, std::numbers::pi);
    wandering_ = 0.0;
  }
  turn_rate_ = (heading_ - before) / settings_.step;
}

}  // namespace penumbra::slam::brain
