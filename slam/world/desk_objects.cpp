// Things that stand and lie on desks and on the floor beside them.
#include "slam/world/office_objects.h"
#include "slam/world/office_parts.h"

namespace penumbra::slam::synthetic {

Object& add_monitor(World& world, RandomSequence& random, float h) {
  const bool lit = random.chance(0.35F);
  const int screen = office_material(world, random, Surface::screen, Colour::Constant(0.012F),
                                     lit ? pick_tint(random) : Colour(Colour::Zero()));
  const int shell =
      office_material(world, random, Surface::plastic, Colour::Constant(random.chance(0.6F) ? 0.02F : 0.45F));
  const float half = random.uniform(0.22F, 0.30F), tall = half * random.uniform(1.15F, 1.3F);
  const float low = h + random.uniform(0.08F, 0.14F);
  return add_classed(world,
                     {block(0.0F, 0.0F, half, 0.016F, low, low + tall, screen),
                      block(0.0F, 0.03F, 0.6F * half, 0.02F, low + 0.15F * tall, low + 0.85F * tall, shell),
                      block(0.0F, 0.035F, 0.03F, 0.015F, h, low + 0.3F * tall, shell),
                      with_material(make_cylinder({0.0F, -h - 0.008F, 0.02F}, 1, 0.12F, 0.016F), shell)},
                     ObjectClass::tv);
}

Object& add_keyboard(World& world, RandomSequence& random, float h) {
  const int keys =
      office_material(world, random, Surface::keys, Colour::Constant(random.chance(0.7F) ? 0.025F : 0.5F));
  return add_classed(world, {block(0.0F, 0.0F, 0.22F, 0.075F, h, h + 0.022F, keys)}, ObjectClass::keyboard);
}

Object& add_mouse(World& world, RandomSequence& random, float h) {
  const int shell =
      office_material(world, random, Surface::plastic, Colour::Constant(random.uniform(0.02F, 0.3F)));
  return add_classed(
      world, {with_material(make_ellipsoid({0.0F, -h - 0.012F, 0.0F}, {0.03F, 0.02F, 0.052F}), shell)},
      ObjectClass::mouse);
}

Object& add_cup(World& world, RandomSequence& random, float h) {
  const int china = two_paints(world, random, Surface::spines);
  return add_classed(
      world,
      {with_material(make_cylinder({0.0F, -h - 0.048F, 0.0F}, 1, 0.04F, 0.096F), china),
       with_material(make_ellipsoid({0.052F, -h - 0.05F, 0.0F}, {0.022F, 0.03F, 0.008F}), china)},
      ObjectClass::cup);
}

Object& add_books(World& world, RandomSequence& random, float h) {
  std::vector<Body> bodies;
  const int count = 1 + random.below(4);
  float low = h;
  for (int i = 0; i < count; ++i) {
    const int cover = two_paints(world, random, Surface::poster);
    const float thick = random.uniform(0.015F, 0.045F), x = random.uniform(-0.02F, 0.02F),
                z = random.uniform(-0.02F, 0.02F), half_x = random.uniform(0.07F, 0.11F),
                half_z = random.uniform(0.10F, 0.14F);
    bodies.push_back(block(x, z, half_x, half_z, low, low + thick, cover));
    low += thick;
  }
  return add_classed(world, bodies, ObjectClass::book);
}

Object& add_bottle(World& world, RandomSequence& random, float h) {
  const int glass = office_material(world, random, Surface::plastic, pick_tint(random));
  const int label = two_paints(world, random, Surface::spines);
  return add_classed(world,
                     {with_material(make_cylinder({0.0F, -h - 0.08F, 0.0F}, 1, 0.034F, 0.16F), glass),
                      with_material(make_cylinder({0.0F, -h - 0.085F, 0.0F}, 1, 0.035F, 0.08F), label),
                      with_material(make_ellipsoid({0.0F, -h - 0.16F, 0.0F}, {0.034F, 0.05F, 0.034F}), glass),
                      with_material(make_cylinder({0.0F, -h - 0.215F, 0.0F}, 1, 0.014F, 0.05F), glass)},
                     ObjectClass::bottle);
}

Object& add_box(World& world, RandomSequence& random, float h) {
  const int card =
      office_material(world, random, Surface::poster, Colour(0.48F, 0.34F, 0.20F), pick_tint(random));
  const float half_x = random.uniform(0.15F, 0.22F), half_z = random.uniform(0.12F, 0.16F),
              tall = random.uniform(0.2F, 0.32F);
  return add_classed(world, {block(0.0F, 0.0F, half_x, half_z, h, h + tall, card)}, ObjectClass::box);
}

Object& add_papers(World& world, RandomSequence& random, float h) {
  std::vector<Body> bodies;
  for (int i = 0; i < 3; ++i) {
    const int sheet =
        office_material(world, random, Surface::poster, Colour::Constant(0.72F), Colour::Constant(0.1F));
    const float level = h + 0.002F * static_cast<float>(i);
    const float x = random.uniform(-0.12F, 0.12F), z = random.uniform(-0.06F, 0.06F);
    bodies.push_back(block(x, z, 0.105F, 0.148F, level, level + 0.002F, sheet));
  }
  return add_thing(world, Thing::small_thing, bodies);
}

Object& add_backpack(World& world, RandomSequence& random) {
  const int cloth = plain_material(world, random, pick_tint(random) * 0.5F, Surface::cloth);
  Body sack = make_ellipsoid({0.0F, -0.22F, 0.0F}, {0.17F, 0.25F, 0.12F});
  cut(sack, {0.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F});
  return add_classed(world,
                     {with_material(sack, cloth),
                      with_material(make_ellipsoid({0.0F, -0.15F, -0.10F}, {0.11F, 0.10F, 0.05F}), cloth)},
                     ObjectClass::backpack);
}

}  // namespace penumbra::slam::synthetic
