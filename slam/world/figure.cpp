#include "slam/world/figure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "slam/world/object_parts.h"

namespace penumbra::slam::synthetic {

namespace {

constexpr double kThigh = 0.245, kShin = 0.246, kFoot = 0.039, kTrunk = 0.288, kUpperArm = 0.186,
                 kForearm = 0.146, kHipHalf = 0.05, kShoulderHalf = 0.118, kNeck = 0.022;

SE3 turned(int axis, double angle, const Eigen::Vector3d& offset = Eigen::Vector3d::Zero()) {
  return {Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)).toRotationMatrix(), offset};
}

constexpr std::size_t at(Limb limb) { return static_cast<std::size_t>(limb); }
constexpr std::size_t at(Limb left, int side) {
  return static_cast<std::size_t>(left) + static_cast<std::size_t>(side);
}

struct Materials {
  int shirt = 0, sleeve = 0, trousers = 0, skin = 0, hair = 0, shoe = 0, dark = 0, lip = 0;
};

Colour pick_dye(RandomSequence& random) {
  static const Colour kDyes[] = {{0.40F, 0.06F, 0.05F},  {0.06F, 0.10F, 0.30F}, {0.55F, 0.52F, 0.46F},
                                 {0.03F, 0.03F, 0.035F}, {0.10F, 0.24F, 0.14F}, {0.62F, 0.62F, 0.64F},
                                 {0.10F, 0.22F, 0.34F},  {0.34F, 0.22F, 0.10F}, {0.22F, 0.22F, 0.24F}};
  const Colour dye = kDyes[random.below(static_cast<int>(std::size(kDyes)))];
  return dye * random.uniform(0.8F, 1.2F);
}

int garment(World& world, RandomSequence& random, const Colour& colour, const Colour& pattern) {
  Material material;
  material.surface = Surface::garment;
  material.colour = colour;
  material.accent = pattern;
  material.seed = random.bits();
  return add_material(world, material);
}

Materials dress(World& world, RandomSequence& random) {
  Materials materials;
  const Colour shirt = pick_dye(random);
  // A pattern that stands out.
  Colour pattern = pick_dye(random);
  if (std::abs(pattern.mean() - shirt.mean()) < 0.2F)
    pattern = Colour::Constant(shirt.mean() > 0.25F ? 0.04F : 0.6F);
  materials.shirt = garment(world, random, shirt, pattern);
  const Colour skin = Colour(0.58F, 0.38F, 0.28F) * random.uniform(0.35F, 1.1F);
  materials.skin = plain_material(world, random, skin, Surface::skin);
  materials.sleeve = random.chance(0.4F) ? materials.skin : materials.shirt;
  const Colour cloth = pick_dye(random) * 0.5F;
  const Colour other = cloth * random.uniform(0.6F, 1.7F);
  materials.trousers = garment(world, random, cloth, other);
  static const Colour kHair[] = {
      {0.03F, 0.02F, 0.015F}, {0.10F, 0.06F, 0.03F}, {0.30F, 0.20F, 0.09F}, {0.28F, 0.27F, 0.26F}};
  const Colour hair = kHair[random.below(4)];
  materials.hair = plain_material(world, random, hair, Surface::cloth);
  const Colour shoe = pick_dye(random) * 0.6F;
  materials.shoe = plain_material(world, random, shoe);
  materials.dark = plain_material(world, random, Colour(0.02F, 0.015F, 0.012F));
  materials.lip = plain_material(world, random, Colour(0.30F, 0.12F, 0.10F));
  return materials;
}

}  // namespace

double standing_height(const Posture& posture, double stature) {
  double height = 0.0;
  for (const std::size_t side : {0U, 1U}) {
    const double leg =
        std::cos(posture.spread[side]) *
        (kThigh * std::cos(posture.hip[side]) + kShin * std::cos(posture.hip[side] - posture.knee[side]));
    height = std::max(height, leg + kFoot);
  }
  return height * stature;
}

Skeleton skeleton_of(const Posture& p, double h) {
  Skeleton limbs;
  const SE3 pelvis = turned(1, p.heading, {p.x, -p.pelvis_height, p.z});
  limbs[at(Limb::pelvis)] = pelvis;
  const SE3 trunk = pelvis * turned(1, p.twist) * turned(2, p.sway) * turned(0, -p.lean);
  limbs[at(Limb::trunk)] = trunk;
  const SE3 head = trunk * turned(1, p.turn, {0.0, -(kTrunk + kNeck) * h, 0.0}) * turned(0, -p.nod);
  limbs[at(Limb::head)] = head;
  limbs[at(Limb::hair)] = head;
  for (const int side : {0, 1}) {
    const auto s = static_cast<std::size_t>(side);
    const double right = side == 0 ? -1.0 : 1.0;
    const SE3 upper = trunk *
                      turned(2, -right * p.raise[s], {right * kShoulderHalf * h, -(kTrunk - 0.02) * h, 0.0}) *
                      turned(0, p.shoulder[s]);
    limbs[at(Limb::left_upper_arm, side)] = upper;
    const SE3 forearm =
        upper * turned(1, -right * p.in[s], {0.0, kUpperArm * h, 0.0}) * turned(0, p.elbow[s]);
    limbs[at(Limb::left_forearm, side)] = forearm;
    limbs[at(Limb::left_hand, side)] = forearm * turned(0, 0.12, {0.0, kForearm * h, 0.0});
    const SE3 thigh =
        pelvis * turned(2, -right * p.spread[s], {right * kHipHalf * h, 0.0, 0.0}) * turned(0, p.hip[s]);
    limbs[at(Limb::left_thigh, side)] = thigh;
    const SE3 shin = thigh * turned(0, -p.knee[s], {0.0, kThigh * h, 0.0});
    limbs[at(Limb::left_shin, side)] = shin;
    // Feet stay level but for a little of the shin's own turn.
    limbs[at(Limb::left_foot, side)] = shin * turned(0, 0.75 * (p.knee[s] - p.hip[s]), {0.0, kShin * h, 0.0});
  }
  return limbs;
}

void add_figure(World& world, RandomSequence& random, const Build& build, std::uint16_t instance,
                const std::function<Posture(double)>& posture_at) {
  const Materials materials = dress(world, random);
  const auto h = static_cast<float>(build.stature);
  const float g = build.girth;
  const bool long_hair = random.chance(0.4F);
  const double stature = build.stature;
  const auto add = [&](Limb limb, const std::vector<Body>& bodies) {
    Object& object = add_object(world, bodies);
    object.object_class = ObjectClass::person;
    object.instance = instance;
    object.motion.moves = true;
    object.motion.placement = [posture_at, stature, limb](double time) {
      return skeleton_of(posture_at(time), stature)[at(limb)];
    };
  };
  const auto ball = [](const Eigen::Vector3f& centre, const Eigen::Vector3f& radii, int material) {
    return with_material(make_ellipsoid(centre, radii), material);
  };
  // A limb from the joint down to `length`, tapering a little: two ellipsoids that overlap.
  const auto limb_bodies = [&](float length, float top, float bottom, int material) {
    return std::vector<Body>{ball({0.0F, 0.32F * length, 0.0F}, {top, 0.48F * length, top}, material),
                             ball({0.0F, 0.68F * length, 0.0F}, {bottom, 0.45F * length, bottom}, material)};
  };
  add(Limb::pelvis,
      {ball({0.0F, -0.02F * h, 0.0F}, {0.098F * h * g, 0.085F * h, 0.072F * h * g}, materials.trousers)});
  Body chest = make_ellipsoid({0.0F, -0.205F * h, 0.0F}, {0.118F * h * g, 0.115F * h, 0.068F * h * g});
  Body belly = make_ellipsoid({0.0F, -0.10F * h, 0.004F * h}, {0.095F * h * g, 0.125F * h, 0.066F * h * g});
  Body waist = make_cylinder({0.0F, -0.155F * h, 0.0F}, 1, 0.09F * h * g, 0.17F * h);
  waist.inverse_radii.z() = 1.0F / (0.064F * h * g);
  add(Limb::trunk, {with_material(chest, materials.shirt), with_material(belly, materials.shirt),
                    with_material(waist, materials.shirt),
                    ball({0.0F, -0.29F * h, 0.0F}, {0.03F * h, 0.055F * h, 0.034F * h}, materials.skin)});
  add(Limb::head,
      {ball({0.0F, -0.07F * h, 0.012F * h}, {0.044F * h, 0.067F * h, 0.052F * h}, materials.skin),
       ball({0.0F, -0.055F * h, 0.066F * h}, {0.009F * h, 0.014F * h, 0.012F * h}, materials.skin),
       ball({-0.018F * h, -0.078F * h, 0.056F * h}, {0.008F * h, 0.004F * h, 0.006F * h}, materials.dark),
       ball({0.018F * h, -0.078F * h, 0.056F * h}, {0.008F * h, 0.004F * h, 0.006F * h}, materials.dark),
       ball({0.0F, -0.028F * h, 0.054F * h}, {0.014F * h, 0.004F * h, 0.006F * h}, materials.lip)});
  std::vector<Body> hair{
      ball({0.0F, -0.088F * h, -0.004F * h}, {0.049F * h, 0.056F * h, 0.054F * h}, materials.hair)};
  if (long_hair)
    hair.push_back(
        ball({0.0F, -0.05F * h, -0.024F * h}, {0.046F * h, 0.075F * h, 0.032F * h}, materials.hair));
  add(Limb::hair, hair);
  const auto upper_arm = static_cast<float>(kUpperArm) * h, forearm = static_cast<float>(kForearm) * h,
             thigh = static_cast<float>(kThigh) * h, shin = static_cast<float>(kShin) * h;
  for (const int side : {0, 1}) {
    const auto of = [&](Limb left) { return static_cast<Limb>(at(left, side)); };
    add(of(Limb::left_upper_arm), limb_bodies(upper_arm, 0.034F * h * g, 0.028F * h * g, materials.shirt));
    add(of(Limb::left_forearm), limb_bodies(forearm, 0.026F * h * g, 0.02F * h * g, materials.sleeve));
    add(of(Limb::left_hand),
        {ball({0.0F, 0.04F * h, 0.004F * h}, {0.012F * h, 0.05F * h, 0.024F * h}, materials.skin)});
    add(of(Limb::left_thigh), limb_bodies(thigh, 0.052F * h * g, 0.04F * h * g, materials.trousers));
    add(of(Limb::left_shin), limb_bodies(shin, 0.036F * h * g, 0.028F * h * g, materials.trousers));
    add(of(Limb::left_foot),
        {ball({0.0F, 0.014F * h, 0.035F * h}, {0.025F * h, 0.025F * h, 0.075F * h}, materials.shoe)});
  }
}

}  // namespace penumbra::slam::synthetic
