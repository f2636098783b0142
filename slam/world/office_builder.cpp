#include "slam/world/office_builder.h"

#include <cmath>
#include <numbers>

#include "slam/world/object_parts.h"
#include "slam/world/office_objects.h"
#include "slam/world/office_people.h"

namespace penumbra::slam::synthetic {

namespace {

constexpr double kPi = std::numbers::pi;

class OfficeBuilder {
 public:
  OfficeBuilder(const OfficePlan& plan, std::uint32_t seed) : plan_(plan), random_(hash_of(seed, 0x0ff1ceU)) {
    world_.seed = seed;
    world_.catalogue = kOfficeCatalogue;
    world_.ground = false;
    world_.room = Room{};
  }

  World build(People people, double seconds) {
    light();
    raise_walls();
    furnish_middle();
    furnish_wall({0.0, plan_.half_z}, 0.0, plan_.half_x, true);
    furnish_wall({-plan_.half_x, 0.0}, -0.5 * kPi, plan_.half_z, false);
    furnish_wall({plan_.half_x, 0.0}, 0.5 * kPi, plan_.half_z, true);
    furnish_wall({0.0, -plan_.half_z}, kPi, plan_.half_x, true);
    add_people(world_, random_, {people, seconds, chairs_, [this] { return ++instances_; }});
    if (people == People::none) {
      for (const GroundPose& chair : chairs_) put(add_chair(world_, random_, random_.chance(0.5F)), chair);
    }
    return std::move(world_);
  }

 private:
  double between(float from, float to) { return static_cast<double>(random_.uniform(from, to)); }

  void put(Object& object, const GroundPose& pose) {
    object.pose = pose;
    if (object.object_class != ObjectClass::background) object.instance = ++instances_;
  }
  // (x, z) of the frame of `pose` in the world.
  static GroundPose placed(const GroundPose& pose, double x, double z, double turn = 0.0) {
    const Eigen::Matrix3d rotation = rotation_of(pose.heading);
    const Eigen::Vector3d offset = rotation * Eigen::Vector3d(x, 0.0, z);
    return {pose.position + Eigen::Vector2d(offset.x(), offset.z()), pose.heading + turn};
  }

  void light() {
    Room& room = *world_.room;
    room.lower = Eigen::Vector3d(-plan_.half_x, -plan_.height, -plan_.half_z).cast<float>();
    room.upper = Eigen::Vector3d(plan_.half_x, 0.0, plan_.half_z).cast<float>();
    room.lamp_light = random_.uniform(0.65F, 1.0F);
    room.sunny = random_.chance(0.45F);
    world_.sky_colour = Colour(0.55F, 0.60F, 0.66F) * random_.uniform(0.7F, 1.2F);
    world_.sun_colour = {2.1F, 1.95F, 1.7F};
    const float height = random_.uniform(0.5F, 0.8F), azimuth = random_.uniform(-0.5F, 0.5F);
    world_.to_sun = Eigen::Vector3f(-std::cos(height) * std::cos(azimuth), -std::sin(height),
                                    std::cos(height) * std::sin(azimuth));
    room.windows = static_cast<int>(2.0 * plan_.half_z / 1.75);
    room.window_top = -2.25F;
    room.window_bottom = -0.95F;
    room.window_first = -0.5F * (room.window_step * static_cast<float>(room.windows - 1) + room.window_width);
    for (int i = -1; i <= 1; ++i) {
      for (int k = -1; k <= 1; ++k)
        room.lamps.emplace_back(1.9F * static_cast<float>(i), 1.7F * static_cast<float>(k));
    }
  }

  int material(Surface surface, const Colour& colour) {
    Material made;
    made.surface = surface;
    made.colour = colour;
    made.seed = random_.bits();
    return add_material(world_, made);
  }

  void add_background(const Eigen::Vector3f& lower, const Eigen::Vector3f& upper, int surface,
                      Thing thing = Thing::nothing) {
    add_thing(world_, thing, {with_material(make_box(lower, upper), surface)});
  }

  void raise_walls() {
    const Room& room = *world_.room;
    const Eigen::Vector3f &a = room.lower, &b = room.upper;
    constexpr float kThick = 0.2F;
    static const Colour kPaints[] = {{0.72F, 0.71F, 0.68F}, {0.66F, 0.67F, 0.64F}, {0.70F, 0.64F, 0.54F}};
    const Colour paint = kPaints[random_.below(3)];
    static const Colour kCarpets[] = {{0.20F, 0.21F, 0.24F}, {0.30F, 0.27F, 0.23F}, {0.16F, 0.20F, 0.17F}};
    const Colour carpet = kCarpets[random_.below(3)];
    add_background({a.x(), 0.0F, a.z()}, {b.x(), kThick, b.z()}, material(Surface::carpet, carpet));
    add_background({a.x(), a.y() - kThick, a.z()}, {b.x(), a.y(), b.z()},
                   material(Surface::ceiling, Colour::Constant(0.66F)));
    const int wall = material(Surface::painted_wall, paint);
    add_background({a.x() - kThick, a.y(), a.z()}, {a.x(), 0.0F, b.z()}, wall);
    add_background({b.x(), a.y(), a.z()}, {b.x() + kThick, 0.0F, b.z()}, wall);
    add_background({a.x(), a.y(), a.z() - kThick}, {b.x(), 0.0F, a.z()}, wall);
    add_background({a.x(), a.y(), b.z()}, {b.x(), 0.0F, b.z() + kThick}, wall);
    for (int i = 0; i < room.windows; ++i) {
      const float z = room.window_first + room.window_step * static_cast<float>(i);
      add_background({a.x(), room.window_top, z}, {a.x() + 0.01F, room.window_bottom, z + room.window_width},
                     material(Surface::window, Colour::Constant(0.6F)));
    }
    const int lamp = material(Surface::lamp, Colour::Constant(0.8F));
    for (const Eigen::Vector2f& at : room.lamps) {
      add_background({at.x() - Room::kLampHalfX, a.y(), at.y() - Room::kLampHalfZ},
                     {at.x() + Room::kLampHalfX, a.y() + 0.05F, at.y() + Room::kLampHalfZ}, lamp,
                     Thing::lamp);
    }
    for (const double z : {-2.2, 0.9, 2.3})
      add_pipe(world_, random_, static_cast<float>(1.8 * plan_.half_x), random_.uniform(0.04F, 0.11F), 2.55F)
          .pose = {{0.0, z}, 0.0};
  }

  void add_workplace(const GroundPose& pose, float width, float depth) {
    add_desk(world_, random_, width, depth).pose = pose;
    const Eigen::Matrix2d to_world = (Eigen::Matrix2d() << std::cos(pose.heading), std::sin(pose.heading),
                                      -std::sin(pose.heading), std::cos(pose.heading))
                                         .finished();
    world_.room->shelters.push_back({.x = static_cast<float>(pose.position.x()),
                                     .y = -kDeskHeight,
                                     .z = static_cast<float>(pose.position.y()),
                                     .to_local = to_world.transpose().cast<float>(),
                                     .half_x = 0.5F * width,
                                     .half_z = 0.5F * depth});
    const double half = 0.5 * static_cast<double>(width);
    const double shift = between(-0.15F, 0.15F);
    const double tilt = between(-0.25F, 0.25F);
    put(add_monitor(world_, random_, kDeskHeight), placed(pose, shift, 0.16, tilt));
    const double keys_turn = between(-0.1F, 0.1F), keys_x = shift + between(-0.05F, 0.05F);
    put(add_keyboard(world_, random_, kDeskHeight), placed(pose, keys_x, -0.16, keys_turn));
    const double mouse_turn = between(-0.3F, 0.3F);
    put(add_mouse(world_, random_, kDeskHeight), placed(pose, shift + 0.33, -0.15, mouse_turn));
    if (random_.chance(0.7F)) {
      const double turn = between(-3.0F, 3.0F), z = between(-0.2F, 0.2F);
      put(add_cup(world_, random_, kDeskHeight), placed(pose, -half + 0.15, z, turn));
    }
    if (random_.chance(0.8F)) {
      const double turn = between(-0.5F, 0.5F), z = between(0.0F, 0.2F);
      put(add_books(world_, random_, kDeskHeight), placed(pose, half - 0.17, z, turn));
    }
    if (random_.chance(0.5F))
      put(add_bottle(world_, random_, kDeskHeight), placed(pose, half - 0.1, -0.2, 0.0));
    if (random_.chance(0.7F)) {
      const double turn = between(-0.5F, 0.5F);
      add_papers(world_, random_, kDeskHeight).pose = placed(pose, -half + 0.3, -0.15, turn);
    }
    if (random_.chance(0.3F)) {
      const double turn = between(-0.3F, 0.3F);
      put(add_box(world_, random_, kDeskHeight), placed(pose, -half + 0.22, 0.2, turn));
    }
    if (random_.chance(0.3F)) {
      const double turn = between(-1.0F, 1.0F), x = between(-0.4F, 0.4F);
      put(add_backpack(world_, random_), placed(pose, x, 0.05, turn));
    }
    std::vector<Eigen::Vector3f> cable{{0.1F, -0.7F, 0.28F}};
    for (int i = 0; i < 4; ++i) {
      const float x = cable.back().x() + random_.uniform(-0.15F, 0.2F);
      const float y = i < 2 ? cable.back().y() + 0.34F : -0.008F;
      const float z =
          i < 2 ? 0.28F + random_.uniform(-0.05F, 0.03F) : cable.back().z() - random_.uniform(0.1F, 0.25F);
      cable.emplace_back(x, std::min(y, -0.008F), z);
    }
    add_cable(world_, random_, cable).pose = pose;
  }

  void furnish_middle() {
    constexpr float kWidth = 1.4F, kDepth = 0.75F;
    add_workplace({{-0.71, 0.0}, 0.0}, kWidth, kDepth);
    add_workplace({{0.71, 0.0}, 0.0}, kWidth, kDepth);
    const GroundPose panel{{0.0, 0.43}, 0.0};
    add_partition(world_, random_, 3.0F, 1.32F).pose = panel;
    for (const double x : {-1.0, 0.05, 1.0}) {
      const float wide = random_.uniform(0.3F, 0.5F), tall = random_.uniform(0.4F, 0.55F);
      const double at = x + between(-0.12F, 0.12F);
      if (random_.chance(0.75F))
        add_poster(world_, random_, wide, tall, 1.0F).pose = placed(panel, at, -0.03);
      const double behind = -x + between(-0.12F, 0.12F);
      if (random_.chance(0.5F))
        add_poster(world_, random_, wide, tall, 0.95F).pose = placed(panel, behind, 0.03, kPi);
    }
    const double left = between(0.5F, 1.3F), right = -between(0.0F, 0.9F);
    chairs_.push_back({{-1.1 + between(-0.1F, 0.1F), -0.82}, left});
    chairs_.push_back({{0.95 + between(-0.1F, 0.1F), -0.92}, right});
    const double x = between(-0.3F, 0.3F), turn = between(-0.6F, 0.6F);
    put(add_chair(world_, random_, random_.chance(0.5F)), {{x, -0.55}, turn});
  }

  // Fills a wall from its left to its right end: `middle` is its middle, `heading` points into it.
  void furnish_wall(const Eigen::Vector2d& middle, double heading, double half_length, bool tall_things) {
    const GroundPose wall{middle, heading};
    double along = -half_length + 0.35;
    while (along < half_length - 0.5) {
      const double room_left = half_length - 0.2 - along;
      const float choice = random_.uniform();
      if (choice < 0.3F && room_left > 1.5) {
        const double width = between(1.2F, 1.5F);
        add_workplace(placed(wall, along + 0.5 * width, -0.4), static_cast<float>(width), 0.7F);
        const double turn = between(-0.7F, 0.7F), x = along + 0.5 * width + between(-0.2F, 0.2F);
        put(add_chair(world_, random_, random_.chance(0.5F)), placed(wall, x, -0.95, turn));
        if (tall_things) hang_poster(wall, along + 0.5 * width, 1.75F);
        along += width + 0.1;
      } else if (choice < 0.55F && tall_things && room_left > 1.0) {
        const double width = between(0.8F, 1.2F), height = between(1.5F, 2.1F);
        add_shelf(world_, random_, placed(wall, along + 0.5 * width, -0.17), static_cast<float>(width),
                  static_cast<float>(height), [this](Object& books) { books.instance = ++instances_; });
        if (random_.chance(0.5F) && height < 2.0)
          put(add_box(world_, random_, static_cast<float>(height) + 0.02F),
              placed(wall, along + 0.5 * width, -0.17));
        along += width + 0.15;
      } else if (choice < 0.68F) {
        put(add_plant(world_, random_), placed(wall, along + 0.25, -0.3));
        along += 0.6;
      } else if (choice < 0.78F) {
        const double turn = between(-0.4F, 0.4F);
        put(add_box(world_, random_, 0.0F), placed(wall, along + 0.25, -0.3, turn));
        along += 0.55;
      } else if (choice < 0.92F && tall_things) {
        hang_poster(wall, along + 0.4, 1.45F);
        along += 0.9;
      } else {
        along += between(0.7F, 1.2F);  // plain wall
      }
    }
  }

  void hang_poster(const GroundPose& wall, double along, float height) {
    const float wide = random_.uniform(0.45F, 0.75F), tall = wide * random_.uniform(1.0F, 1.5F);
    add_poster(world_, random_, wide, tall, height).pose = placed(wall, along, -0.001);
  }

  OfficePlan plan_;
  RandomSequence random_;
  World world_;
  std::vector<GroundPose> chairs_;
  std::uint16_t instances_ = 0;
};

}  // namespace

World build_office(const OfficePlan& plan, People people, double seconds, std::uint32_t seed) {
  return OfficeBuilder(plan, seed).build(people, seconds);
}

}  // namespace penumbra::slam::synthetic
