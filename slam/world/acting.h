// What a person does over time: a script of steps, played once when the world is built, and the posture at
// any time that comes of it.
//
// The play advances 60 times a second with bounds on speed, acceleration and turning, so that whatever the
// script says the body moves smoothly. In between, states are interpolated; limbs follow from states by
// functions of the phase of the gait (angle of the stride, 2 pi for two steps), how far somebody sits, what
// the hands do, and slow noise for gestures.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "slam/world/figure.h"

namespace penumbra::slam::synthetic {

constexpr double kSeatHeight = 0.47;  // metres, of chairs
constexpr double kSeatBehind = 0.38;  // metres from where somebody stands up to the middle of the chair

// Where and how something stands, as T_world_object in the plane.
SE3 on_ground(const GroundPose& pose, double height = 0.0);

struct Step {
  enum class Kind : std::uint8_t { sit, rise, walk, stand, grasp, release };
  Kind kind = Kind::stand;
  double seconds = 0.0;                             // how long: sit, stand
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // (x, z): where to walk to; where a chair is to sit on
  double heading = 0.0;                             // of the chair
  double speed = 1.1;                               // metres a second
  int prop = -1;                                    // which one to grasp
};

// Something that people push or carry.
struct Prop {
  SE3 start;             // where it is at first
  bool carried = false;  // in front of the chest; else pushed along on the ground
};

struct ActorState {
  double x = 0.0, z = 0.0, heading = 0.0;  // where the feet are or would be
  double speed = 0.0;
  double phase = 0.0;                    // of the gait
  double seated = 0.0;                   // 0 stands, 1 sits
  double carrying = 0.0, pushing = 0.0;  // how far the arms are at it
};

class Performance {
 public:
  static constexpr double kStepsPerSecond = 60.0;

  // Plays `steps` for `seconds`, beginning with the first one's place: seated there if it is `sit`. After the
  // last step they begin again from step `loop_from`.
  Performance(const Build& build, const std::vector<Step>& steps, int loop_from, std::vector<Prop> props,
              double liveliness, std::uint32_t seed, double seconds);

  Posture posture_at(double time) const;
  SE3 prop_at(int prop, double time) const;
  // Whether the prop ever leaves its place.
  bool prop_moves(int prop) const { return moved_[static_cast<std::size_t>(prop)]; }
  ActorState state_at(double time) const;

 private:
  void play(const std::vector<Step>& steps, int loop_from, double seconds);
  void keep_props(int held, double since);

  Build build_;
  std::vector<Prop> props_;
  double liveliness_;  // of gestures
  std::uint32_t seed_;
  std::vector<ActorState> states_;
  std::vector<std::vector<SE3>> prop_places_;  // of each prop, one a state
  std::vector<bool> moved_;
  SE3 grip_;  // from the person to what is held
};

}  // namespace penumbra::slam::synthetic
