// A person of rigid limbs: a skeleton of joints posed by forward kinematics, each limb an object of its own.
//
//   T_world_limb = T_world_pelvis  product over the joints up to the limb of (offset in the parent, rotation)
//
// Every limb hangs down from its joint (y) when the person stands, x is to the right, z ahead. Lengths are
// shares of the stature h: thigh .245, shin .246, foot height .039, trunk .288, upper arm .186, forearm .146,
// hand .108 (Drillis and Contini, Body Segment Parameters, 1966; Winter, Biomechanics of Human Movement).
// Joints bend in planes of their own; that is enough for people who sit, walk, gesture and carry.
#pragma once

#include <array>
#include <functional>

#include "slam/world/noise.h"
#include "slam/world/world.h"

namespace penumbra::slam::synthetic {

// Angles in radians, 0 = standing at attention; [0] is the left side, [1] the right.
struct Posture {
  double x = 0.0, z = 0.0, heading = 0.0;         // of the pelvis over the ground, metres
  double pelvis_height = 0.9;                     // metres above the floor
  double lean = 0.0, twist = 0.0, sway = 0.0;     // of the trunk: forwards, about its axis, to the right
  double nod = 0.0, turn = 0.0;                   // of the head: forwards, to the right
  std::array<double, 2> hip{}, spread{}, knee{};  // thigh forwards and outwards; shin backwards
  std::array<double, 2> shoulder{}, raise{}, elbow{}, in{};  // arm forwards, outwards; forearm up, inwards
};

enum class Limb : std::uint8_t {
  pelvis,
  trunk,
  head,
  hair,
  left_upper_arm,
  right_upper_arm,
  left_forearm,
  right_forearm,
  left_hand,
  right_hand,
  left_thigh,
  right_thigh,
  left_shin,
  right_shin,
  left_foot,
  right_foot,
};
constexpr int kLimbs = 16;

using Skeleton = std::array<SE3, kLimbs>;  // T_world_limb

// The limbs of a person `stature` metres tall.
Skeleton skeleton_of(const Posture& posture, double stature);
// Height of the pelvis above the floor at which the lower foot of a standing person touches it.
double standing_height(const Posture& posture, double stature);

struct Build {
  double stature = 1.75;  // metres
  float girth = 1.0F;     // widths over those of an average person
};

// Adds the limbs of one person of class person and number `instance`, dressed by `random`; `posture_at` gives
// the posture at a time in seconds.
void add_figure(World& world, RandomSequence& random, const Build& build, std::uint16_t instance,
                const std::function<Posture(double)>& posture_at);

}  // namespace penumbra::slam::synthetic
