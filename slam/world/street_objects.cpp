// Houses, trees and street furniture.
#include "slam/world/street_objects.h"

#include <cmath>

#include "slam/world/object_parts.h"

namespace penumbra::slam::synthetic {

namespace {

Colour pick_wall(RandomSequence& random, bool brick) {
  static const Colour kBricks[] = {{0.38F, 0.15F, 0.09F}, {0.45F, 0.22F, 0.13F}, {0.30F, 0.14F, 0.10F}};
  static const Colour kPlasters[] = {{0.62F, 0.55F, 0.40F}, {0.66F, 0.63F, 0.56F}, {0.58F, 0.42F, 0.26F},
                                     {0.50F, 0.50F, 0.47F}, {0.68F, 0.58F, 0.34F}, {0.42F, 0.46F, 0.44F},
                                     {0.60F, 0.38F, 0.30F}, {0.48F, 0.54F, 0.58F}};
  const Colour colour = brick ? kBricks[random.below(static_cast<int>(std::size(kBricks)))]
                              : kPlasters[random.below(static_cast<int>(std::size(kPlasters)))];
  return colour * random.uniform(0.85F, 1.1F);
}

}  // namespace

Object& add_house(World& world, RandomSequence& random, float width, float depth) {
  Material wall;
  wall.surface = Surface::facade;
  wall.seed = random.bits();
  FacadeStyle& style = wall.facade;
  style.brick = random.chance(0.35F);
  wall.colour = pick_wall(random, style.brick);
  static const Colour kDoors[] = {{0.10F, 0.16F, 0.10F},
                                  {0.25F, 0.07F, 0.05F},
                                  {0.08F, 0.10F, 0.20F},
                                  {0.22F, 0.14F, 0.07F},
                                  {0.30F, 0.30F, 0.28F}};
  wall.accent = kDoors[random.below(static_cast<int>(std::size(kDoors)))];
  style.storey = random.uniform(2.7F, 3.3F);
  const float wished = random.uniform(1.9F, 2.9F);
  style.column = width / std::round(width / wished);
  style.window_width = style.column * random.uniform(0.38F, 0.52F);
  style.window_height = random.uniform(1.25F, 1.75F);
  style.sill = random.uniform(0.75F, 0.95F);
  style.door_column = random.below(static_cast<int>(width / style.column + 0.5F));
  style.shutters = random.chance(0.3F);
  style.shop = random.chance(0.2F);
  const int storeys = 2 + random.below(3);
  const float height = style.storey * static_cast<float>(storeys) + random.uniform(0.2F, 0.7F);

  const float hx = 0.5F * depth, hz = 0.5F * width;
  std::vector<Body> bodies{make_box({-hx, -height, -hz}, {hx, 0.0F, hz})};
  bodies[0].material = add_material(world, wall);
  bodies[0].casts_shadow = true;

  Material roof;
  roof.surface = Surface::roof;
  roof.seed = random.bits();
  static const Colour kTiles[] = {{0.32F, 0.12F, 0.07F}, {0.18F, 0.10F, 0.08F}, {0.13F, 0.13F, 0.15F}};
  roof.colour = kTiles[random.below(static_cast<int>(std::size(kTiles)))];
  const int roof_material = add_material(world, roof);
  const float eaves = 0.35F;
  if (random.chance(0.75F)) {
    // A ridge along the street: planes through the eaves that lean over the house.
    const float rise = depth * random.uniform(0.30F, 0.42F);
    Body gable = make_box({-hx - eaves, -height - rise, -hz - 0.1F}, {hx + eaves, -height, hz + 0.1F});
    cut(gable, {-hx - eaves, -height - 0.12F, 0.0F}, {-rise, -hx - eaves, 0.0F});
    cut(gable, {hx + eaves, -height - 0.12F, 0.0F}, {rise, -hx - eaves, 0.0F});
    gable.casts_shadow = true;
    bodies.push_back(with_material(gable, roof_material));
    const float chimney_z = random.uniform(-0.6F, 0.6F) * hz;
    const int brick = plain_material(world, random, {0.33F, 0.17F, 0.12F});
    bodies.push_back(with_material(make_box({0.4F, -height - rise - 0.7F, chimney_z - 0.35F},
                                            {1.1F, -height - 0.5F * rise, chimney_z + 0.35F}),
                                   brick));
  } else {
    bodies.push_back(
        with_material(make_box({-hx - 0.25F, -height - 0.35F, -hz - 0.05F}, {hx + 0.2F, -height, hz + 0.05F}),
                      roof_material));
  }
  // Balconies or a bay in front of some windows give the facade real depth.
  if (random.chance(0.45F)) {
    const int trim = plain_material(world, random, Colour::Constant(random.uniform(0.3F, 0.6F)));
    const int columns = static_cast<int>(width / style.column + 0.5F);
    const int step = 2 + random.below(2);
    for (int column = random.below(2); column < columns; column += step) {
      const float z = -hz + (static_cast<float>(column) + 0.5F) * style.column;
      const float y = -style.storey - 0.15F;
      const float half = 0.5F * style.window_width + 0.3F;
      bodies.push_back(
          with_material(make_box({-hx - 0.9F, y - 0.95F, z - half}, {-hx, y + 0.18F, z + half}), trim));
    }
  }
  return add_thing(world, Thing::facade, bodies);
}

Object& add_tree(World& world, RandomSequence& random) {
  const float height = random.uniform(5.0F, 8.5F), trunk = random.uniform(0.11F, 0.2F);
  std::vector<Body> bodies;
  bodies.push_back(make_cylinder({0.0F, -0.3F * height, 0.0F}, 1, trunk, 0.6F * height));
  bodies[0].material = plain_material(world, random, {0.17F, 0.13F, 0.09F}, Surface::bark);
  bodies[0].casts_shadow = true;
  const float g = random.uniform(0.8F, 1.2F);
  const float blue = random.uniform(0.03F, 0.06F), red = random.uniform(0.07F, 0.15F);
  const Colour leaf = Colour(red, 0.17F, blue) * g;
  const int leaves = plain_material(world, random, leaf, Surface::leaves);
  const int crowns = 4 + random.below(3);
  for (int i = 0; i < crowns; ++i) {
    const float turn = 6.2831853F * (static_cast<float>(i) + random.uniform()) / static_cast<float>(crowns);
    const float out = i == 0 ? 0.0F : random.uniform(0.5F, 1.1F);
    const float radius = (i == 0 ? 0.24F : random.uniform(0.13F, 0.19F)) * height;
    const Eigen::Vector3f centre(out * std::cos(turn),
                                 -height * (i == 0 ? 0.72F : random.uniform(0.52F, 0.85F)),
                                 out * std::sin(turn));
    Body crown = make_ellipsoid(centre, {radius, radius * random.uniform(0.7F, 0.95F), radius});
    crown.ragged = true;
    crown.casts_shadow = i < 3;
    bodies.push_back(with_material(crown, leaves));
  }
  return add_thing(world, Thing::plant, bodies);
}

Object& add_lamp(World& world, RandomSequence& random) {
  const int metal = plain_material(world, random, Colour::Constant(random.uniform(0.12F, 0.3F)));
  const float height = random.uniform(5.5F, 7.0F);
  std::vector<Body> bodies{make_cylinder({0.0F, -0.5F * height, 0.0F}, 1, 0.075F, height),
                           make_cylinder({-0.7F, -height, 0.0F}, 0, 0.045F, 1.5F),
                           make_box({-1.75F, -height - 0.08F, -0.13F}, {-1.25F, -height + 0.07F, 0.13F}),
                           make_box({-0.11F, -1.0F, -0.11F}, {0.11F, 0.0F, 0.11F})};
  for (Body& body : bodies) body.material = metal;
  bodies[0].casts_shadow = true;
  return add_thing(world, Thing::lamp, bodies);
}

Object& add_sign(World& world, RandomSequence& random, const GroundPose& pose) {
  static const Colour kSigns[] = {{0.55F, 0.03F, 0.03F}, {0.03F, 0.10F, 0.50F}, {0.70F, 0.55F, 0.05F}};
  Material plate;
  plate.surface = Surface::sign;
  plate.colour = kSigns[random.below(static_cast<int>(std::size(kSigns)))];
  plate.seed = random.bits();
  const float height = random.uniform(2.2F, 2.6F);
  Body post = make_cylinder({0.0F, -0.5F * height - 0.15F, 0.0F}, 1, 0.035F, height + 0.3F);
  post.material = plain_material(world, random, Colour::Constant(0.35F));
  add_object(world, {post}).pose = pose;
  const int plate_material = add_material(world, plate);
  Object& sign = add_object(
      world, {with_material(random.chance(0.6F)
                                ? make_cylinder({0.0F, -height, -0.05F}, 2, 0.34F, 0.03F)
                                : make_box({-0.3F, -height - 0.3F, -0.06F}, {0.3F, -height + 0.3F, -0.03F}),
                            plate_material)});
  sign.object_class = ObjectClass::sign;
  sign.pose = pose;
  return sign;
}

Object& add_bin(World& world, RandomSequence& random) {
  static const Colour kBins[] = {
      {0.05F, 0.12F, 0.06F}, {0.06F, 0.06F, 0.07F}, {0.30F, 0.25F, 0.05F}, {0.04F, 0.08F, 0.2F}};
  const Colour colour = kBins[random.below(static_cast<int>(std::size(kBins)))];
  std::vector<Body> bodies{
      make_swept({{-0.24F, 0.0F}, {0.24F, 0.0F}, {0.32F, -0.95F}, {-0.32F, -0.95F}}, 0.28F)};
  bodies[0].material = plain_material(world, random, colour);
  bodies.push_back(make_swept({{-0.36F, -0.95F}, {0.36F, -0.95F}, {0.30F, -1.05F}, {-0.36F, -1.05F}}, 0.32F));
  bodies[1].material = plain_material(world, random, colour * 1.3F);
  bodies[0].casts_shadow = true;
  return add_thing(world, Thing::small_thing, bodies);
}

Object& add_hedge(World& world, RandomSequence& random, float length) {
  const float height = random.uniform(0.8F, 1.6F);
  const float g = random.uniform(0.8F, 1.2F), red = random.uniform(0.06F, 0.11F);
  const Colour leaf = Colour(red, 0.15F, 0.04F) * g;
  Body hedge = make_box({-0.4F, -height, -0.5F * length}, {0.4F, 0.0F, 0.5F * length});
  hedge.material = plain_material(world, random, leaf, Surface::leaves);
  hedge.casts_shadow = true;
  return add_thing(world, Thing::plant, {hedge});
}

}  // namespace penumbra::slam::synthetic
