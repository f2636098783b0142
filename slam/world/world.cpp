#include "slam/world/world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace penumbra::slam::synthetic {

namespace {

using enum ObjectClass;
constexpr ObjectClass kStreetClasses[] = {person, cyclist, car, truck, sign};
constexpr ObjectClass kOfficeClasses[] = {person, chair,  tv,           keyboard, mouse, cup,
                                          book,   bottle, potted_plant, backpack, box};

}  // namespace

const Catalogue kStreetCatalogue{"The synthetic street of Penumbra", kStreetClasses};
const Catalogue kOfficeCatalogue{"The synthetic office of Penumbra", kOfficeClasses};

const char* name_of(ObjectClass object_class) {
  static constexpr const char* kNames[kObjectClasses] = {
      "background", "person", "cyclist", "car",  "truck",  "sign",         "chair",    "tv",
      "keyboard",   "mouse",  "cup",     "book", "bottle", "potted plant", "backpack", "box"};
  return kNames[static_cast<int>(object_class)];
}

const char* name_of(Thing thing) {
  static constexpr const char* kNames[kThings] = {"nothing", "person",    "vehicle",    "sign",
                                                  "lamp",    "plant",     "facade",     "screen",
                                                  "poster",  "furniture", "small thing"};
  return kNames[static_cast<int>(thing)];
}

Thing thing_of(const Object& object) {
  using enum Thing;
  static constexpr Thing kThingOf[kObjectClasses] = {
      nothing,     person,      vehicle,     vehicle,     vehicle,     sign,  furniture,   screen,
      small_thing, small_thing, small_thing, small_thing, small_thing, plant, small_thing, small_thing};
  return object.thing != nothing ? object.thing : kThingOf[static_cast<int>(object.object_class)];
}

namespace {

// Where the camera is along its route; beyond the last frame it goes on at its last speed.
double camera_arc_at(const World& world, double time) {
  const std::vector<double>& arc = world.camera_arc;
  if (arc.size() < 2) return arc.empty() ? 0.0 : arc.front();
  const double frame = std::max(0.0, time * kFrameRate);
  const std::size_t i = std::min(static_cast<std::size_t>(frame), arc.size() - 2);
  return arc[i] + (frame - static_cast<double>(i)) * (arc[i + 1] - arc[i]);
}

}  // namespace

GroundPose pose_at(const World& world, const Object& object, double time) {
  if (!object.motion.moves) return object.pose;
  double arc = object.motion.arc + object.motion.speed * time;
  if (object.motion.leads) {
    constexpr double kPeriod = 12.0;  // seconds from the farthest place to the nearest and back
    const double far = 0.5 + 0.5 * std::cos(2.0 * std::numbers::pi * time / kPeriod);
    arc = camera_arc_at(world, time) + object.motion.nearest +
          far * (object.motion.farthest - object.motion.nearest);
  }
  GroundPose pose = world.route.at(arc, object.motion.right);
  if (object.motion.speed < 0.0) pose.heading += std::numbers::pi;
  return pose;
}

SE3 placement_at(const World& world, const Object& object, double time) {
  if (object.motion.placement) return object.motion.placement(time);
  const GroundPose pose = pose_at(world, object, time);
  return {rotation_of(pose.heading), {pose.position.x(), 0.0, pose.position.y()}};
}

Eigen::Matrix3d rotation_of(double heading) {
  return Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitY()).toRotationMatrix();
}

Object& add_object(World& world, const std::vector<Body>& bodies) {
  Object object;
  object.first_body = static_cast<int>(world.bodies.size());
  object.body_count = static_cast<int>(bodies.size());
  object.lower = bodies.front().lower;
  object.upper = bodies.front().upper;
  for (const Body& body : bodies) {
    object.lower = object.lower.cwiseMin(body.lower);
    object.upper = object.upper.cwiseMax(body.upper);
    world.bodies.push_back(body);
  }
  world.objects.push_back(object);
  return world.objects.back();
}

Object& add_thing(World& world, Thing thing, const std::vector<Body>& bodies) {
  Object& object = add_object(world, bodies);
  object.thing = thing;
  return object;
}

int add_material(World& world, const Material& material) {
  world.materials.push_back(material);
  return static_cast<int>(world.materials.size()) - 1;
}

}  // namespace penumbra::slam::synthetic
