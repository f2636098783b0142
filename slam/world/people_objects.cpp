// People on foot and on bicycles.
#include <cmath>

#include "slam/world/object_parts.h"
#include "slam/world/street_objects.h"

namespace penumbra::slam::synthetic {

namespace {

Colour pick_cloth(RandomSequence& random) {
  static const Colour kCloths[] = {{0.45F, 0.06F, 0.05F}, {0.06F, 0.10F, 0.28F}, {0.55F, 0.50F, 0.42F},
                                   {0.05F, 0.05F, 0.06F}, {0.12F, 0.28F, 0.16F}, {0.60F, 0.60F, 0.62F}};
  return kCloths[random.below(static_cast<int>(std::size(kCloths)))];
}

Colour pick_skin(RandomSequence& random) { return Colour(0.55F, 0.36F, 0.26F) * random.uniform(0.4F, 1.1F); }

// A bar in the (z, y) plane, `thickness` high and 2 `half_width` wide.
Body make_bar(const Eigen::Vector2f& from, const Eigen::Vector2f& to, float thickness, float half_width) {
  const Eigen::Vector2f along = (to - from).normalized();
  const Eigen::Vector2f across = Eigen::Vector2f(-along.y(), along.x()) * (0.5F * thickness);
  return make_swept({from - across, to - across, to + across, from + across}, half_width);
}

// A wheel is a ring of straight pieces, so that the road shows through it.
void add_ring(std::vector<Body>& bodies, const Eigen::Vector2f& hub, float radius, int material) {
  constexpr int kPieces = 9;
  constexpr float kTyre = 0.045F;
  const auto rim = [&](int i) -> Eigen::Vector2f {
    const float turn = 6.2831853F * static_cast<float>(i) / kPieces;
    return hub + (radius - 0.5F * kTyre) * Eigen::Vector2f(std::cos(turn), std::sin(turn));
  };
  for (int i = 0; i < kPieces; ++i) {
    bodies.push_back(with_material(make_bar(rim(i), rim(i + 1), kTyre, 0.02F), material));
  }
}

}  // namespace

Object& add_person(World& world, RandomSequence& random) {
  const float h = random.uniform(1.58F, 1.88F);
  const int shirt = plain_material(world, random, pick_cloth(random), Surface::cloth);
  const int trousers = plain_material(world, random, pick_cloth(random) * 0.5F, Surface::cloth);
  const int skin = plain_material(world, random, pick_skin(random));
  const int hair = plain_material(world, random, Colour(0.08F, 0.05F, 0.03F));
  const float stride = random.uniform(0.08F, 0.22F);
  std::vector<Body> bodies;
  for (const float side : {-1.0F, 1.0F}) {
    // Legs and arms lean with the stride: boxes cut along the slant.
    const float foot = side * stride, hip = 0.47F * h;
    const Body leg =
        make_swept({{foot - 0.07F, 0.0F}, {foot + 0.16F, 0.0F}, {0.10F, -hip}, {-0.10F, -hip}}, 0.075F);
    bodies.push_back(with_material(shifted(leg, side * 0.09F), trousers));
    const float hand = -side * stride;
    bodies.push_back(with_material(
        make_ellipsoid({side * 0.235F, -0.64F * h, 0.4F * hand}, {0.06F, 0.17F * h, 0.085F}), shirt));
    bodies.push_back(
        with_material(make_ellipsoid({side * 0.235F, -0.47F * h, hand}, {0.045F, 0.05F * h, 0.05F}), skin));
  }
  Body torso = make_ellipsoid({0.0F, -0.65F * h, 0.0F}, {0.215F, 0.21F * h, 0.135F});
  torso.casts_shadow = true;
  bodies.push_back(with_material(torso, shirt));
  bodies.push_back(
      with_material(make_ellipsoid({0.0F, -0.925F * h, 0.01F}, {0.085F, 0.075F * h, 0.10F}), skin));
  bodies.push_back(
      with_material(make_ellipsoid({0.0F, -0.945F * h, -0.015F}, {0.092F, 0.065F * h, 0.10F}), hair));
  Object& object = add_object(world, bodies);
  object.object_class = ObjectClass::person;
  return object;
}

Object& add_cyclist(World& world, RandomSequence& random) {
  const int shirt = plain_material(world, random, pick_cloth(random), Surface::cloth);
  const int trousers = plain_material(world, random, pick_cloth(random) * 0.5F, Surface::cloth);
  const int skin = plain_material(world, random, pick_skin(random));
  const int helmet = plain_material(world, random, pick_cloth(random));
  const int paint = plain_material(world, random, pick_cloth(random) * 0.8F);
  const int rubber = plain_material(world, random, Colour::Constant(0.03F));
  std::vector<Body> bodies;

  // The bicycle; places are (z, y).
  constexpr float kWheel = 0.34F;
  const Eigen::Vector2f rear(-0.53F, -kWheel), front(0.55F, -kWheel), crank(-0.06F, -0.29F),
      saddle(-0.22F, -0.88F), head(0.38F, -0.86F), bars(0.36F, -1.03F);
  add_ring(bodies, rear, kWheel, rubber);
  add_ring(bodies, front, kWheel, rubber);
  const Eigen::Vector2f tubes[][2] = {{rear, crank}, {rear, saddle}, {crank, saddle},
                                      {crank, head}, {saddle, head}, {bars, front}};
  for (const auto& tube : tubes) {
    bodies.push_back(with_material(make_bar(tube[0], tube[1], 0.042F, 0.02F), paint));
  }
  bodies.push_back(
      with_material(make_ellipsoid({0.0F, saddle.y() - 0.02F, saddle.x()}, {0.08F, 0.04F, 0.13F}), rubber));
  bodies.push_back(with_material(make_cylinder({0.0F, bars.y(), bars.x()}, 0, 0.022F, 0.54F), rubber));

  // The rider.
  const float size = random.uniform(0.93F, 1.07F), turn = random.uniform(0.0F, 6.2831853F);
  const Eigen::Vector2f hip(-0.2F, -0.98F);
  const Eigen::Vector2f shoulder = hip + size * Eigen::Vector2f(random.uniform(0.2F, 0.4F), -0.47F);
  for (const float side : {-1.0F, 1.0F}) {
    // The foot goes round with the pedal; the knee lies before the line from hip to foot.
    const float phase = turn + (side > 0.0F ? 3.1415927F : 0.0F);
    const Eigen::Vector2f foot = crank + 0.17F * Eigen::Vector2f(std::cos(phase), std::sin(phase));
    const Eigen::Vector2f down = foot - hip;
    const float bend = std::sqrt(std::max(0.01F, 0.2F - 0.25F * down.squaredNorm()));
    const Eigen::Vector2f knee = 0.5F * (hip + foot) + bend *
                                                           Eigen::Vector2f(-down.y(), down.x()).normalized() *
                                                           (down.y() > 0.0F ? -1.0F : 1.0F);
    bodies.push_back(with_material(shifted(make_bar(hip, knee, 0.16F, 0.07F), side * 0.1F), trousers));
    bodies.push_back(with_material(shifted(make_bar(knee, foot, 0.11F, 0.055F), side * 0.1F), trousers));
    bodies.push_back(with_material(
        make_ellipsoid({side * 0.1F, foot.y(), foot.x() + 0.05F}, {0.045F, 0.04F, 0.13F}), rubber));
    bodies.push_back(with_material(shifted(make_bar(shoulder, bars, 0.085F, 0.045F), side * 0.21F), shirt));
  }
  Body torso = make_bar(hip, shoulder, 0.25F, 0.19F);
  torso.casts_shadow = true;
  bodies.push_back(with_material(torso, shirt));
  bodies.push_back(with_material(
      make_ellipsoid({0.0F, shoulder.y() - 0.19F, shoulder.x() + 0.08F}, {0.085F, 0.13F, 0.10F}), skin));
  bodies.push_back(with_material(
      make_ellipsoid({0.0F, shoulder.y() - 0.26F, shoulder.x() + 0.07F}, {0.10F, 0.085F, 0.14F}), helmet));
  Object& object = add_object(world, bodies);
  object.object_class = ObjectClass::cyclist;
  return object;
}

}  // namespace penumbra::slam::synthetic
