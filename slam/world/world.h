// The synthetic world as plain data: what street_builder makes and ray_caster shows.
//
// World frame: x right, y down, z forward, metres, the ground is y = 0. An object is a group of convex bodies
// in the object's own frame (same axes, its middle on the ground at the origin), placed by a GroundPose.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "slam/geometry/se3.h"
#include "slam/world/body.h"
#include "slam/world/road_map.h"
#include "slam/world/route.h"

namespace penumbra::slam::synthetic {

using Colour = Eigen::Vector3f;  // linear red, green, blue; 1 = a white wall in full light

enum class Surface : std::uint8_t {
  matte,  // one colour with fractal noise, for furniture and tests
  facade,
  roof,
  car_body,
  car_cabin,
  wheel,
  bark,
  leaves,
  cloth,
  sign,
  lorry,
  // Indoors, see office_material.cpp.
  painted_wall,
  ceiling,
  carpet,
  wood,
  poster,
  screen,
  keys,
  spines,
  window,
  lamp,
  garment,
  skin,
  plastic,  // smooth: metal, shells of devices
};

// The rhythm of a facade, in metres.
struct FacadeStyle {
  float storey = 2.9F;  // height of a storey
  float column = 2.4F;  // distance between windows
  float window_width = 1.1F, window_height = 1.4F, sill = 0.9F;
  int door_column = 1;
  bool brick = false, shutters = false, shop = false;
};

// What the painter of a car body needs to place arches, lamps and windows, in metres.
struct CarStyle {
  float length = 4.3F, width = 1.76F, height = 1.46F;
  float belt = 0.92F;  // height of the lower edge of the windows
  float wheel_radius = 0.31F, axle_front = 1.30F, axle_rear = -1.30F;
  bool van = false;  // the windows are painted on the body, which has no cabin of its own
};

struct Material {
  Surface surface = Surface::matte;
  Colour colour = Colour::Constant(0.5F);
  Colour accent = Colour::Constant(0.5F);  // doors, shutters, curtains, rims; a garment's pattern
  std::uint32_t seed = 0;
  FacadeStyle facade;
  CarStyle car;
};

// The numbers are the category ids of the annotations.
enum class ObjectClass : std::uint8_t {
  background = 0,
  person = 1,
  cyclist = 2,
  car = 3,
  truck = 4,
  sign = 5,
  chair = 6,
  tv = 7,  // monitors
  keyboard = 8,
  mouse = 9,
  cup = 10,
  book = 11,
  bottle = 12,
  potted_plant = 13,
  backpack = 14,
  box = 15
};
constexpr int kObjectClasses = 16;
// COCO's name where COCO has the class.
const char* name_of(ObjectClass object_class);

// What a thing is to somebody who looks for landmarks: coarser than ObjectClass, but it has houses, trees
// and lamps, which are no objects to be annotated.
enum class Thing : std::uint8_t {
  nothing = 0,  // ground, sky, walls
  person = 1,
  vehicle = 2,
  sign = 3,
  lamp = 4,
  plant = 5,
  facade = 6,
  screen = 7,
  poster = 8,
  furniture = 9,
  small_thing = 10
};
constexpr int kThings = 11;
const char* name_of(Thing thing);

// What annotations of a world say about it.
struct Catalogue {
  const char* description;
  std::span<const ObjectClass> classes;
};
extern const Catalogue kStreetCatalogue, kOfficeCatalogue;

// Driving along the world's route: at constant speed (a negative one drives against the route's direction),
// or leading the camera at a distance that swings between two values.
struct Motion {
  bool moves = false;
  double arc = 0.0;    // metres along the route at time 0
  double speed = 0.0;  // metres per second
  double right = 0.0;  // metres to the right of the route
  bool leads = false;
  double nearest = 0.0, farthest = 0.0;  // metres along the route ahead of the camera, where it leads
  // Any rigid motion, in place of all that: T_world_object at a time in seconds. Limbs have one each.
  std::function<SE3(double)> placement = {};
};

struct Object {
  ObjectClass object_class = ObjectClass::background;
  std::uint16_t instance = 0;    // 0 = background; objects that share one are parts of one thing
  Thing thing = Thing::nothing;  // of background; what thing_of makes of all others follows from their class
  int first_body = 0, body_count = 0;
  GroundPose pose;  // where it stands unless it moves
  Motion motion;
  Eigen::Vector3f lower = Eigen::Vector3f::Zero(), upper = Eigen::Vector3f::Zero();  // box around its bodies
  float sunlight = 1.0F;  // share of the sun that houses leave to it
};

// The top of a desk, which keeps light from what is below it.
struct Shelter {
  float x = 0.0F, y = 0.0F, z = 0.0F;                      // its middle, world frame
  Eigen::Matrix2f to_local = Eigen::Matrix2f::Identity();  // (x, z) of the world to those of the desk
  float half_x = 0.0F, half_z = 0.0F;
};

// A closed room with its lights; room_light.cpp says how it is lit. Metres, world frame.
struct Room {
  static constexpr float kLampHalfX = 0.6F, kLampHalfZ = 0.15F;

  Eigen::Vector3f lower = Eigen::Vector3f::Zero(), upper = Eigen::Vector3f::Zero();
  // Windows are in the wall x = lower.x: panes between two heights, one every window_step along z.
  float window_top = 0.0F, window_bottom = 0.0F;  // y
  float window_first = 0.0F, window_width = 1.2F, window_step = 1.6F;
  int windows = 0;
  std::vector<Eigen::Vector2f> lamps;  // (x, z) of their middles, on the ceiling
  float lamp_light = 0.9F;             // of a white surface that faces up
  bool sunny = false;                  // the sun shines in
  std::vector<Shelter> shelters;
};

struct World {
  std::uint32_t seed = 0;
  Catalogue catalogue = kStreetCatalogue;
  std::optional<Room> room;        // empty: under the sky
  Route route;                     // the camera's track, which moving objects follow
  std::vector<double> camera_arc;  // along the route, one per frame
  RoadMap road_map;                // markings, kerbs and pavements follow it
  bool ground = true;              // false: nothing but the objects and the sky
  std::vector<Material> materials;
  std::vector<Body> bodies;
  std::vector<Object> objects;
  Eigen::Vector3f to_sun = Eigen::Vector3f(0.5F, -0.75F, -0.35F).normalized();  // unit vector
  Colour sun_colour{1.45F, 1.30F, 1.08F};
  Colour sky_colour{0.34F, 0.40F, 0.50F};  // ambient light from above
  float clouds = 0.0F;                     // 0: fair weather, 1: a grey sky
  Colour sky_tint = Colour::Ones();        // of the sky's colours, as in the evening
  float texture = 1.0F;                    // contrast of the noise on surfaces
};

// Cross-section of a street, metres from its centreline. Traffic keeps to the right.
constexpr float kLaneCentre = 1.65F;    // where cars drive; the camera's route is one
constexpr float kParkingLine = 3.35F;   // marking between lane and parked cars
constexpr float kParkedCentre = 4.42F;  // parked cars
constexpr float kKerb = 5.5F;           // the road ends
constexpr float kPavementEnd = 8.2F;    // gardens and houses begin

// Where `object` is at `time` seconds; the first for those that keep to the ground.
GroundPose pose_at(const World& world, const Object& object, double time);
SE3 placement_at(const World& world, const Object& object, double time);
// Rotation of an object with that heading: its axes in the world's frame.
Eigen::Matrix3d rotation_of(double heading);
// Adds `bodies` as one object and computes its bounding box; the pose is left to the caller.
Object& add_object(World& world, const std::vector<Body>& bodies);
// The same for background that may be a landmark.
Object& add_thing(World& world, Thing thing, const std::vector<Body>& bodies);
// What `object` is.
Thing thing_of(const Object& object);
// Adds a material and returns its index.
int add_material(World& world, const Material& material);

}  // namespace penumbra::slam::synthetic
