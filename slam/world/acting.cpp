#include "slam/world/acting.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace penumbra::slam::synthetic {

namespace {

constexpr double kTick = 1.0 / Performance::kStepsPerSecond;
constexpr double kAcceleration = 1.8, kTurning = 2.6;  // metres and radians a second
constexpr double kRising = 1.2;                        // seconds to stand up or sit down
constexpr double kGrasping = 0.6;                      // seconds to take something
constexpr double kArrived = 0.12;                      // metres

double angle_between(double from, double to) { return std::remainder(to - from, 2.0 * std::numbers::pi); }
double smooth(double t) {
  const double c = std::clamp(t, 0.0, 1.0);
  return c * c * (3.0 - 2.0 * c);
}
double towards(double value, double target, double step) {
  return value < target ? std::min(target, value + step) : std::max(target, value - step);
}
double blend_of(double a, double b, double share) { return a + (b - a) * share; }

SE3 place_of(const ActorState& state) { return on_ground({{state.x, state.z}, state.heading}); }

// Where a carried thing is in front of the chest.
SE3 before_chest() { return {Eigen::Matrix3d::Identity(), {0.0, -1.12, 0.42}}; }

SE3 between(const SE3& from, const SE3& to, double share) {
  return from * SE3::exp(share * (from.inverse() * to).log());
}

}  // namespace

SE3 on_ground(const GroundPose& pose, double height) {
  return {rotation_of(pose.heading), {pose.position.x(), -height, pose.position.y()}};
}

Performance::Performance(const Build& build, const std::vector<Step>& steps, int loop_from,
                         std::vector<Prop> props, double liveliness, std::uint32_t seed, double seconds)
    : build_(build), props_(std::move(props)), liveliness_(liveliness), seed_(seed) {
  prop_places_.resize(props_.size());
  moved_.resize(props_.size());
  play(steps, loop_from, seconds);
}

// Adds the props' places at the last state; `held` (or -1) follows the person since `since` seconds.
void Performance::keep_props(int held, double since) {
  for (std::size_t i = 0; i < props_.size(); ++i) {
    auto& places = prop_places_[i];
    const SE3 last = places.empty() ? props_[i].start : places.back();
    if (static_cast<int>(i) != held) {
      places.push_back(last);
      continue;
    }
    const SE3 person = place_of(states_.back());
    const SE3 grip = props_[i].carried ? between(grip_, before_chest(), smooth(since / kGrasping)) : grip_;
    places.push_back(person * grip);
    moved_[i] = true;
  }
}

void Performance::play(const std::vector<Step>& steps, int loop_from, double seconds) {
  ActorState state;
  const Step& first = steps.front();
  state.heading = first.heading;
  state.seated = first.kind == Step::Kind::sit ? 1.0 : 0.0;
  state.x = first.place.x() + state.seated * kSeatBehind * std::sin(first.heading);
  state.z = first.place.y() + state.seated * kSeatBehind * std::cos(first.heading);
  std::size_t step = 0;
  int held = -1;
  double in_step = 0.0, held_for = 0.0;
  double seat = state.seated;  // 0..1 before smoothing
  const int ticks = static_cast<int>(std::ceil(seconds / kTick)) + 2;
  states_.reserve(static_cast<std::size_t>(ticks));
  for (int tick = 0; tick < ticks; ++tick) {
    const Step& now = steps[step];
    bool done = false, walks = false;
    double wanted_speed = 0.0;
    switch (now.kind) {
      case Step::Kind::sit:
        seat = towards(seat, 1.0, kTick / kRising);
        state.heading +=
            std::clamp(angle_between(state.heading, now.heading), -kTurning * kTick, kTurning * kTick);
        done = in_step >= now.seconds;
        break;
      case Step::Kind::rise:
        seat = towards(seat, 0.0, kTick / kRising);
        done = seat <= 0.0;
        break;
      case Step::Kind::stand:
        done = in_step >= now.seconds;
        break;
      case Step::Kind::walk: {
        walks = true;
        const Eigen::Vector2d to = now.place - Eigen::Vector2d(state.x, state.z);
        const double distance = to.norm();
        const double off = angle_between(state.heading, std::atan2(to.x(), to.y()));
        state.heading += std::clamp(off, -kTurning * kTick, kTurning * kTick);
        // Slower where the way turns or the next step is no walk.
        const std::size_t next = step + 1 < steps.size() ? step + 1 : static_cast<std::size_t>(loop_from);
        const bool stops = steps[next].kind != Step::Kind::walk;
        wanted_speed = now.speed * std::max(0.05, std::cos(std::min(1.5, std::abs(off))));
        if (stops) wanted_speed = std::min(wanted_speed, std::sqrt(2.0 * kAcceleration * 0.6 * distance));
        done = distance < (stops ? kArrived : 0.35);
        break;
      }
      case Step::Kind::grasp:
        if (held < 0) {
          held = now.prop;
          held_for = 0.0;
          const auto& places = prop_places_[static_cast<std::size_t>(held)];
          grip_ = place_of(state).inverse() *
                  (places.empty() ? props_[static_cast<std::size_t>(held)].start : places.back());
        }
        done = in_step >= kGrasping;
        break;
      case Step::Kind::release:
        held = -1;
        done = in_step >= kGrasping;
        break;
    }
    state.speed =
        towards(state.speed, walks ? wanted_speed : 0.0, kAcceleration * (walks ? 1.0 : 1.6) * kTick);
    state.x += state.speed * std::sin(state.heading) * kTick;
    state.z += state.speed * std::cos(state.heading) * kTick;
    // A stride (two steps) of 0.78 times the stature.
    state.phase += 2.0 * std::numbers::pi * state.speed * kTick / (0.78 * build_.stature);
    state.seated = smooth(seat);
    const bool carries = held >= 0 && props_[static_cast<std::size_t>(held)].carried;
    state.carrying = towards(state.carrying, carries ? 1.0 : 0.0, kTick / kGrasping);
    state.pushing = towards(state.pushing, held >= 0 && !carries ? 1.0 : 0.0, kTick / kGrasping);
    states_.push_back(state);
    keep_props(held, held_for);
    in_step += kTick;
    held_for += kTick;
    if (done) {
      in_step = 0.0;
      step = step + 1 < steps.size() ? step + 1 : static_cast<std::size_t>(loop_from);
    }
  }
}

ActorState Performance::state_at(double time) const {
  const double at = std::clamp(time * kStepsPerSecond, 0.0, static_cast<double>(states_.size()) - 1.001);
  const auto i = static_cast<std::size_t>(at);
  const double share = at - static_cast<double>(i);
  const ActorState &a = states_[i], &b = states_[i + 1];
  ActorState state;
  const auto mixed = [&](double ActorState::*field) { state.*field = blend_of(a.*field, b.*field, share); };
  for (const auto field :
       {&ActorState::x, &ActorState::z, &ActorState::speed, &ActorState::phase, &ActorState::heading,
        &ActorState::seated, &ActorState::carrying, &ActorState::pushing}) {
    mixed(field);
  }
  return state;
}

SE3 Performance::prop_at(int prop, double time) const {
  const auto& places = prop_places_[static_cast<std::size_t>(prop)];
  const double at = std::clamp(time * kStepsPerSecond, 0.0, static_cast<double>(places.size()) - 1.001);
  const auto i = static_cast<std::size_t>(at);
  return between(places[i], places[i + 1], at - static_cast<double>(i));
}

Posture Performance::posture_at(double time) const {
  const ActorState state = state_at(time);
  // Slow noise of a channel of its own, -1..1, about `rate` changes a second.
  const auto drift = [&](std::uint32_t channel, double rate) {
    return static_cast<double>(value_noise(static_cast<float>(time * rate), 0.37F, seed_ + 977U * channel));
  };
  Posture p;
  p.x = state.x - state.seated * kSeatBehind * std::sin(state.heading);
  p.z = state.z - state.seated * kSeatBehind * std::cos(state.heading);
  p.heading = state.heading;
  const double gait = std::min(1.0, state.speed / 1.1), sit = state.seated, stand = 1.0 - sit;
  const double gesture = liveliness_ * (0.35 + 0.65 * sit) * (1.0 - gait);
  for (const std::size_t side : {0U, 1U}) {
    const double phase = state.phase + (side == 0 ? 0.0 : std::numbers::pi);
    const double swing = std::sin(phase);
    const auto channel = static_cast<std::uint32_t>(10 * side);
    // Legs: the knee bends while the leg swings forwards (Winter: up to about 60 degrees).
    p.hip[side] = stand * gait * (0.06 + 0.40 * swing) + sit * (1.27 + 0.05 * drift(channel, 0.2));
    const double lift = std::max(0.0, std::cos(phase));
    p.knee[side] =
        stand * gait * (0.10 + 0.85 * lift * lift) + sit * (1.20 + 0.25 * drift(channel + 1, 0.25));
    p.spread[side] = 0.03 + sit * (0.14 + 0.06 * drift(channel + 2, 0.2));
    // Arms swing against the legs; seated they rest on the thighs or gesture.
    const double talk = std::max(0.0, 0.3 + drift(channel + 3, 0.35)) * gesture;
    p.shoulder[side] =
        stand * (-0.42 * gait * swing + 0.05) + sit * 0.45 + talk * (0.55 + 0.35 * drift(channel + 4, 1.1));
    p.raise[side] = 0.10 + 0.06 * sit + talk * (0.25 + 0.35 * drift(channel + 5, 0.9));
    p.elbow[side] = 0.22 + 0.25 * gait * std::max(0.0, -swing) + 0.65 * sit +
                    talk * (0.75 + 0.55 * drift(channel + 6, 1.3));
    p.in[side] = 0.15 + 0.45 * sit + 0.5 * talk * drift(channel + 7, 0.8);
    const double carry = smooth(state.carrying), push = smooth(state.pushing);
    p.shoulder[side] = blend_of(p.shoulder[side], 0.52, carry);
    p.elbow[side] = blend_of(p.elbow[side], 1.05, carry);
    p.in[side] = blend_of(p.in[side], 0.15, carry);
    p.raise[side] = blend_of(p.raise[side], 0.12, carry);
    p.shoulder[side] = blend_of(p.shoulder[side], 0.55, push);
    p.elbow[side] = blend_of(p.elbow[side], 0.55, push);
    p.in[side] = blend_of(p.in[side], 0.0, push);
  }
  const double rising = 4.0 * sit * stand;  // 1 half way up
  p.lean = 0.03 + 0.05 * gait + 0.55 * rising + 0.12 * state.pushing + sit * 0.10 * gesture * drift(40, 0.25);
  p.twist = -0.10 * gait * std::sin(state.phase) + 0.25 * gesture * drift(41, 0.3);
  p.sway = 0.06 * gesture * drift(42, 0.3);
  p.turn = 0.6 * (0.3 + 0.7 * gesture) * drift(43, 0.4);
  p.nod = 0.08 + 0.18 * gesture * drift(44, 0.7);
  const double seat = kSeatHeight + 0.075 * build_.stature;
  const double leg = standing_height(p, build_.stature);  // higher, or the feet would be below the floor
  p.pelvis_height = std::max(leg, blend_of(leg, seat, smooth(sit)));
  return p;
}

}  // namespace penumbra::slam::synthetic
