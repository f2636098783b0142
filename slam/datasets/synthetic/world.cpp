#include "slam/datasets/synthetic/world.h"

#include <numbers>

namespace penumbra::slam::synthetic {

const char* name_of(ObjectClass object_class) {
  static constexpr const char* kNames[kObjectClasses] = {"background", "person", "cyclist",
                                                         "car",        "truck",  "sign"};
  return kNames[static_cast<int>(object_class)];
}

GroundPose pose_at(const World& world, const Object& object, double time) {
  if (!object.motion.moves) return object.pose;
  GroundPose pose = world.route.at(object.motion.arc + object.motion.speed * time, object.motion.right);
  if (object.motion.speed < 0.0) pose.heading += std::numbers::pi;
  return pose;
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

int add_material(World& world, const Material& material) {
  world.materials.push_back(material);
  return static_cast<int>(world.materials.size()) - 1;
}

}  // namespace penumbra::slam::synthetic
