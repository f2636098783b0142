#include "slam/world/office_objects.h"

#include <algorithm>
#include <cmath>

#include "slam/world/object_parts.h"

namespace penumbra::slam::synthetic {

namespace {

int office_material(World& world, RandomSequence& random, Surface surface, const Colour& colour,
                    const Colour& accent = Colour::Constant(0.5F)) {
  Material material;
  material.surface = surface;
  material.colour = colour;
  material.accent = accent;
  material.seed = random.bits();
  return add_material(world, material);
}

Colour pick_tint(RandomSequence& random) {
  static const Colour kPaints[] = {{0.55F, 0.12F, 0.08F}, {0.10F, 0.20F, 0.45F}, {0.62F, 0.55F, 0.20F},
                                   {0.12F, 0.36F, 0.22F}, {0.70F, 0.70F, 0.68F}, {0.08F, 0.08F, 0.09F},
                                   {0.45F, 0.25F, 0.50F}, {0.70F, 0.38F, 0.12F}};
  const Colour picked = kPaints[random.below(static_cast<int>(std::size(kPaints)))];
  return picked * random.uniform(0.7F, 1.1F);
}

// A material of two random paints.
int two_paints(World& world, RandomSequence& random, Surface surface) {
  const Colour first = pick_tint(random), second = pick_tint(random);
  return office_material(world, random, surface, first, second);
}

Colour pick_wood(RandomSequence& random) {
  static const Colour kWoods[] = {
      {0.60F, 0.52F, 0.40F}, {0.52F, 0.36F, 0.20F}, {0.66F, 0.64F, 0.60F}, {0.34F, 0.22F, 0.13F}};
  const Colour picked = kWoods[random.below(static_cast<int>(std::size(kWoods)))];
  return picked * random.uniform(0.9F, 1.1F);
}

// A box by its middle on the ground plane, its lower and upper heights and its half sizes.
Body block(float x, float z, float half_x, float half_z, float low, float high, int material) {
  return with_material(make_box({x - half_x, -high, z - half_z}, {x + half_x, -low, z + half_z}), material);
}

Object& add_thing(World& world, const std::vector<Body>& bodies, ObjectClass object_class) {
  Object& object = add_object(world, bodies);
  object.object_class = object_class;
  return object;
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
  return add_thing(world, bodies, ObjectClass::background);
}

Object& add_partition(World& world, RandomSequence& random, float width, float height) {
  const Colour colour = random.chance(0.5F) ? Colour(0.42F, 0.32F, 0.20F) : pick_tint(random) * 0.7F;
  const int cloth = office_material(world, random, Surface::painted_wall, colour);
  const int frame = office_material(world, random, Surface::plastic, Colour::Constant(0.35F));
  return add_thing(world,
                   {block(0.0F, 0.0F, 0.5F * width, 0.025F, 0.05F, height, cloth),
                    block(0.0F, 0.0F, 0.5F * width, 0.03F, height, height + 0.025F, frame),
                    block(-0.5F * width, 0.0F, 0.02F, 0.16F, 0.0F, height, frame),
                    block(0.5F * width, 0.0F, 0.02F, 0.16F, 0.0F, height, frame)},
                   ObjectClass::background);
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
  return add_thing(world, bodies, ObjectClass::chair);
}

Object& add_monitor(World& world, RandomSequence& random, float h) {
  const bool lit = random.chance(0.35F);
  const int screen = office_material(world, random, Surface::screen, Colour::Constant(0.012F),
                                     lit ? pick_tint(random) : Colour(Colour::Zero()));
  const int shell =
      office_material(world, random, Surface::plastic, Colour::Constant(random.chance(0.6F) ? 0.02F : 0.45F));
  const float half = random.uniform(0.22F, 0.30F), tall = half * random.uniform(1.15F, 1.3F);
  const float low = h + random.uniform(0.08F, 0.14F);
  return add_thing(world,
                   {block(0.0F, 0.0F, half, 0.016F, low, low + tall, screen),
                    block(0.0F, 0.03F, 0.6F * half, 0.02F, low + 0.15F * tall, low + 0.85F * tall, shell),
                    block(0.0F, 0.035F, 0.03F, 0.015F, h, low + 0.3F * tall, shell),
                    with_material(make_cylinder({0.0F, -h - 0.008F, 0.02F}, 1, 0.12F, 0.016F), shell)},
                   ObjectClass::tv);
}

Object& add_keyboard(World& world, RandomSequence& random, float h) {
  const int keys =
      office_material(world, random, Surface::keys, Colour::Constant(random.chance(0.7F) ? 0.025F : 0.5F));
  return add_thing(world, {block(0.0F, 0.0F, 0.22F, 0.075F, h, h + 0.022F, keys)}, ObjectClass::keyboard);
}

Object& add_mouse(World& world, RandomSequence& random, float h) {
  const int shell =
      office_material(world, random, Surface::plastic, Colour::Constant(random.uniform(0.02F, 0.3F)));
  return add_thing(world,
                   {with_material(make_ellipsoid({0.0F, -h - 0.012F, 0.0F}, {0.03F, 0.02F, 0.052F}), shell)},
                   ObjectClass::mouse);
}

Object& add_cup(World& world, RandomSequence& random, float h) {
  const int china = two_paints(world, random, Surface::spines);
  return add_thing(
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
  return add_thing(world, bodies, ObjectClass::book);
}

Object& add_bottle(World& world, RandomSequence& random, float h) {
  const int glass = office_material(world, random, Surface::plastic, pick_tint(random));
  const int label = two_paints(world, random, Surface::spines);
  return add_thing(world,
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
  return add_thing(world, {block(0.0F, 0.0F, half_x, half_z, h, h + tall, card)}, ObjectClass::box);
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
  return add_thing(world, bodies, ObjectClass::background);
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
  add_object(world, frame).pose = pose;
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
    Object& books = add_thing(world, run, ObjectClass::book);
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
  return add_thing(world, bodies, ObjectClass::potted_plant);
}

Object& add_backpack(World& world, RandomSequence& random) {
  const int cloth = plain_material(world, random, pick_tint(random) * 0.5F, Surface::cloth);
  Body sack = make_ellipsoid({0.0F, -0.22F, 0.0F}, {0.17F, 0.25F, 0.12F});
  cut(sack, {0.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.0F});
  return add_thing(world,
                   {with_material(sack, cloth),
                    with_material(make_ellipsoid({0.0F, -0.15F, -0.10F}, {0.11F, 0.10F, 0.05F}), cloth)},
                   ObjectClass::backpack);
}

Object& add_poster(World& world, RandomSequence& random, float width, float tall, float height) {
  const Colour ground = random.chance(0.6F) ? Colour(0.70F, 0.68F, 0.62F) : pick_tint(random);
  const Colour ink = pick_tint(random);
  const int print = office_material(world, random, Surface::poster, ground, ink);
  return add_thing(
      world, {block(0.0F, -0.006F, 0.5F * width, 0.006F, height - 0.5F * tall, height + 0.5F * tall, print)},
      ObjectClass::background);
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
  return add_thing(world, bodies, ObjectClass::background);
}

Object& add_pipe(World& world, RandomSequence& random, float length, float radius, float height) {
  const int metal =
      office_material(world, random, Surface::plastic, Colour::Constant(random.uniform(0.3F, 0.6F)));
  std::vector<Body> bodies{with_material(make_cylinder({0.0F, -height, 0.0F}, 0, radius, length), metal)};
  for (float x = -0.5F * length + 0.4F; x < 0.5F * length; x += 1.3F)
    bodies.push_back(with_material(make_cylinder({x, -height, 0.0F}, 0, 1.15F * radius, 0.05F), metal));
  return add_thing(world, bodies, ObjectClass::background);
}

}  // namespace penumbra::slam::synthetic
