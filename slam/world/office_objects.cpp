// Furniture, and what hangs on walls and under the ceiling.
#include "slam/world/office_objects.h"

#include <algorithm>
#include <cmath>

#include "slam/world/office_parts.h"

namespace penumbra::slam::synthetic {

namespace {

Colour pick_wood(RandomSequence& random) {
  static const Colour kWoods[] = {
      {0.60F, 0.52F, 0.40F}, {0.52F, 0.36F, 0.20F}, {0.66F, 0.64F, 0.60F}, {0.34F, 0.22F, 0.13F}};
  const Colour picked = kWoods[random.below(static_cast<int>(std::size(kWoods)))];
  return picked * random.uniform(0.9F, 1.1F);
}

}  // namespace

Object& add_desk(World& world, RandomSequence& random, float width, float depth) {
  const int top = office_material(world, random, Surface::wood, pick_wood(random));
  const int metal =
      office_material(world, random, Surface::plastic, Colour::Constant(random.uniform(0.1F, 0.5F)));
  const float hx = 0.5F * width, hz = 0.5F * depth;
  std::vector<Body> bodies{block(0.0F, 0.0F, hx, hz, kDeskHeight - 0.03F, kDeskHeight, top)};
  for (const float sx : {-1.0F, 1.0F}) {
    for (const float sz : {-1.0F, 1.0F}) {
      bodies.push_back(
          block(sx * (hx - 0.05F), sz * (hz - 0.05F), 0.03F, 0.03F, 0.0F, kDeskHeight - 0.03F, metal));
    }
  }
  bodies.push_back(
      block(0.0F, hz - 0.06F, hx - 0.06F, 0.012F, kDeskHeight - 0.35F, kDeskHeight - 0.03F, metal));
  return add_thing(world, Thing::furniture, bodies);
}

Object& add_partition(World& world, RandomSequence& random, float width, float height) {
  const Colour colour = random.chance(0.5F) ? Colour(0.42F, 0.32F, 0.20F) : pick_tint(random) * 0.7F;
  const int cloth = office_material(world, random, Surface::painted_wall, colour);
  const int frame = office_material(world, random, Surface::plastic, Colour::Constant(0.35F));
  return add_thing(world, Thing::furniture,
                   {block(0.0F, 0.0F, 0.5F * width, 0.025F, 0.05F, height, cloth),
                    block(0.0F, 0.0F, 0.5F * width, 0.03F, height, height + 0.025F, frame),
                    block(-0.5F * width, 0.0F, 0.02F, 0.16F, 0.0F, height, frame),
                    block(0.5F * width, 0.0F, 0.02F, 0.16F, 0.0F, height, frame)});
}

Object& add_chair(World& world, RandomSequence& random, bool swivels) {
  const int seat = random.chance(0.5F)
                       ? office_material(world, random, Surface::wood, {0.55F, 0.36F, 0.16F})
                       : plain_material(world, random, pick_tint(random) * 0.5F, Surface::cloth);
  const int metal =
      office_material(world, random, Surface::plastic, Colour::Constant(random.uniform(0.03F, 0.4F)));
  std::vector<Body> bodies{block(0.0F, 0.0F, 0.22F, 0.21F, 0.42F, 0.46F, seat)};
  // The back leans a little.
  Body back = make_swept({{-0.20F, -0.58F}, {-0.17F, -0.58F}, {-0.24F, -0.95F}, {-0.27F, -0.95F}}, 0.20F);
  bodies.push_back(with_material(back, seat));
  for (const float side : {-0.14F, 0.14F}) {
    Body bar = shifted(
        make_swept({{-0.19F, -0.42F}, {-0.165F, -0.42F}, {-0.205F, -0.62F}, {-0.23F, -0.62F}}, 0.012F), side);
    bodies.push_back(with_material(bar, metal));
  }
  if (swivels) {
    bodies.push_back(with_material(make_cylinder({0.0F, -0.26F, 0.0F}, 1, 0.03F, 0.32F), metal));
    for (int i = 0; i < 5; ++i) {
      const float turn = 6.2831853F * static_cast<float>(i) / 5.0F, c = std::cos(turn), s = std::sin(turn);
      Body foot = make_ellipsoid({0.16F * s, -0.08F, 0.16F * c},
                                 {0.03F + 0.15F * std::abs(s), 0.025F, 0.03F + 0.15F * std::abs(c)});
      bodies.push_back(with_material(foot, metal));
      bodies.push_back(
          with_material(make_ellipsoid({0.29F * s, -0.03F, 0.29F * c}, {0.03F, 0.03F, 0.03F}), metal));
    }
  } else {
    for (const float sx : {-0.19F, 0.19F}) {
      for (const float sz : {-0.18F, 0.18F})
        bodies.push_back(block(sx, sz, 0.012F, 0.012F, 0.0F, 0.42F, metal));
    }
  }
  return add_classed(world, bodies, ObjectClass::chair);
}

void add_shelf(World& world, RandomSequence& random, const GroundPose& pose, float width, float height,
               const std::function<void(Object&)>& give_instance) {
  constexpr float kDeep = 0.32F, kBoard = 0.02F;
  const int wood = office_material(world, random, Surface::wood, pick_wood(random));
  const float hx = 0.5F * width, hz = 0.5F * kDeep;
  const int boards = std::max(2, static_cast<int>(height / 0.38F));
  const float step = height / static_cast<float>(boards);
  std::vector<Body> frame{block(-hx, 0.0F, kBoard, hz, 0.0F, height, wood),
                          block(hx, 0.0F, kBoard, hz, 0.0F, height, wood),
                          block(0.0F, hz - 0.005F, hx, 0.006F, 0.0F, height, wood)};
  for (int i = 0; i <= boards; ++i) {
    const float y = std::min(height, step * static_cast<float>(i) + kBoard);
    frame.push_back(block(0.0F, 0.0F, hx, hz, y - kBoard, y, wood));
  }
  add_thing(world, Thing::furniture, frame).pose = pose;
  for (int i = 0; i < boards; ++i) {
    // Runs of books of different heights; gaps between some.
    std::vector<Body> run;
    float x = -hx + 0.03F;
    const float low = step * static_cast<float>(i) + kBoard;
    while (x < hx - 0.12F) {
      const float length = std::min(random.uniform(0.10F, 0.32F), hx - 0.03F - x);
      if (!random.chance(0.2F)) {
        const int spines = two_paints(world, random, Surface::spines);
        const float tall = random.uniform(0.55F, 0.85F) * (step - kBoard),
                    deep = random.uniform(0.03F, 0.10F);
        run.push_back(
            with_material(make_box({x, -low - tall, -hz + deep}, {x + length, -low, hz - 0.05F}), spines));
      }
      x += length + 0.004F;
    }
    if (run.empty()) continue;
    Object& books = add_classed(world, run, ObjectClass::book);
    books.pose = pose;
    give_instance(books);
  }
}

Object& add_plant(World& world, RandomSequence& random) {
  const int pot = office_material(world, random, Surface::plastic, pick_tint(random) * 0.7F);
  const int green = plain_material(world, random, Colour(0.05F, 0.14F, 0.03F) * random.uniform(0.7F, 1.5F),
                                   Surface::leaves);
  std::vector<Body> bodies{with_material(make_cylinder({0.0F, -0.16F, 0.0F}, 1, 0.16F, 0.32F), pot)};
  const int crowns = 5 + random.below(4);
  for (int i = 0; i < crowns; ++i) {
    const float turn = random.uniform(0.0F, 6.28F), out = random.uniform(0.05F, 0.22F);
    const float high = random.uniform(0.5F, 1.15F), size = random.uniform(0.10F, 0.2F);
    Body leaf =
        make_ellipsoid({out * std::cos(turn), -high, out * std::sin(turn)}, {size, 0.8F * size, size});
    leaf.ragged = true;
    bodies.push_back(with_material(leaf, green));
  }
  return add_classed(world, bodies, ObjectClass::potted_plant);
}

Object& add_poster(World& world, RandomSequence& random, float width, float tall, float height) {
  const Colour ground = random.chance(0.6F) ? Colour(0.70F, 0.68F, 0.62F) : pick_tint(random);
  const Colour ink = pick_tint(random);
  const int print = office_material(world, random, Surface::poster, ground, ink);
  return add_thing(
      world, Thing::poster,
      {block(0.0F, -0.006F, 0.5F * width, 0.006F, height - 0.5F * tall, height + 0.5F * tall, print)});
}

Object& add_cable(World& world, RandomSequence& random, const std::vector<Eigen::Vector3f>& points) {
  const int rubber = office_material(world, random, Surface::plastic, Colour::Constant(0.03F));
  std::vector<Body> bodies;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    // A cylinder of any direction: an ellipsoid stretched along the piece.
    const Eigen::Vector3f along = points[i + 1] - points[i];
    Body piece = make_box(points[i].cwiseMin(points[i + 1]) - Eigen::Vector3f::Constant(0.006F),
                          points[i].cwiseMax(points[i + 1]) + Eigen::Vector3f::Constant(0.006F));
    Eigen::Vector3f across = along.cross(
        std::abs(along.y()) > 0.9F * along.norm() ? Eigen::Vector3f::UnitX() : Eigen::Vector3f::UnitY());
    across.normalize();
    cut(piece, points[i] + 0.006F * across, across);
    cut(piece, points[i] - 0.006F * across, -across);
    const Eigen::Vector3f other = along.cross(across).normalized();
    cut(piece, points[i] + 0.006F * other, other);
    cut(piece, points[i] - 0.006F * other, -other);
    bodies.push_back(with_material(piece, rubber));
  }
  return add_thing(world, Thing::small_thing, bodies);
}

Object& add_pipe(World& world, RandomSequence& random, float length, float radius, float height) {
  const int metal =
      office_material(world, random, Surface::plastic, Colour::Constant(random.uniform(0.3F, 0.6F)));
  std::vector<Body> bodies{with_material(make_cylinder({0.0F, -height, 0.0F}, 0, radius, length), metal)};
  for (float x = -0.5F * length + 0.4F; x < 0.5F * length; x += 1.3F)
    bodies.push_back(with_material(make_cylinder({x, -height, 0.0F}, 0, 1.15F * radius, 0.05F), metal));
  return add_thing(world, Thing::furniture, bodies);
}

}  // namespace penumbra::slam::synthetic
