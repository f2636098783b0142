// Cars of several shapes.
#include "slam/world/street_objects.h"

namespace penumbra::slam::synthetic {

namespace {

struct CarShape {
  CarStyle style;
  float bonnet;       // length of the bonnet, metres
  float boot;         // length behind the cabin
  float windscreen;   // metres that the windscreen leans back
  float rear_window;  // metres that the rear window leans forward
  float weight;       // share of the cars
};

constexpr CarStyle style_of(float length, float width, float height, float belt, float wheel, float front,
                            float rear, bool van = false) {
  return {length, width, height, belt, wheel, front, rear, van};
}

// clang-format off
constexpr CarShape kShapes[] = {
    {style_of(4.62F, 1.80F, 1.44F, 0.92F, 0.32F, 1.42F, -1.38F), 1.25F, 0.75F, 0.75F, 0.70F, 0.25F},        // saloon
    {style_of(3.95F, 1.71F, 1.48F, 0.93F, 0.30F, 1.22F, -1.22F), 0.95F, 0.06F, 0.70F, 0.35F, 0.32F},        // hatchback
    {style_of(4.66F, 1.80F, 1.47F, 0.93F, 0.32F, 1.42F, -1.36F), 1.20F, 0.06F, 0.75F, 0.40F, 0.20F},        // estate
    {style_of(4.45F, 1.84F, 1.68F, 1.04F, 0.36F, 1.34F, -1.32F), 1.15F, 0.06F, 0.60F, 0.28F, 0.15F},        // off-roader
    {style_of(4.95F, 1.93F, 1.98F, 1.12F, 0.33F, 1.55F, -1.50F, true), 0.85F, 0.00F, 0.80F, 0.05F, 0.08F},  // van
};
// clang-format on

const CarShape& pick_shape(RandomSequence& random) {
  float at = random.uniform();
  for (const CarShape& shape : kShapes) {
    if (at < shape.weight) return shape;
    at -= shape.weight;
  }
  return kShapes[0];
}

Colour pick_paint(RandomSequence& random) {
  static const Colour kPaints[] = {{0.62F, 0.63F, 0.64F}, {0.35F, 0.36F, 0.38F}, {0.10F, 0.10F, 0.11F},
                                   {0.03F, 0.03F, 0.04F}, {0.85F, 0.85F, 0.83F}, {0.80F, 0.80F, 0.80F},
                                   {0.42F, 0.03F, 0.03F}, {0.05F, 0.10F, 0.32F}, {0.10F, 0.24F, 0.42F},
                                   {0.05F, 0.17F, 0.09F}, {0.45F, 0.36F, 0.22F}, {0.55F, 0.16F, 0.03F}};
  const float brightness = random.uniform(0.85F, 1.1F);
  return kPaints[random.below(static_cast<int>(std::size(kPaints)))] * brightness;
}

Body lower_body(const CarShape& shape) {
  const CarStyle& s = shape.style;
  const float front = 0.5F * s.length, rear = -front;
  const float clearance = s.height > 1.6F ? 0.27F : 0.20F;
  // Heights are negative y: up is -y.
  Body body = make_swept({{rear + 0.16F, -clearance},
                          {front - 0.20F, -clearance},
                          {front, -0.46F},
                          {front - 0.08F, -0.72F * s.belt / 0.92F},
                          {front - shape.bonnet, -s.belt},
                          {rear + 0.07F, -s.belt - 0.03F},
                          {rear, -0.55F}},
                         0.5F * s.width, 0.06F, -clearance);
  const float half = 0.5F * s.width;
  // Shoulders below the windows and rounded corners at the front.
  cut(body, {half - 0.02F, -s.belt + 0.13F, 0.0F}, {1.0F, -0.9F, 0.0F});
  cut(body, {-half + 0.02F, -s.belt + 0.13F, 0.0F}, {-1.0F, -0.9F, 0.0F});
  return body;
}

Body cabin(const CarShape& shape) {
  const CarStyle& s = shape.style;
  const float front = 0.5F * s.length - shape.bonnet + 0.12F, rear = -0.5F * s.length + shape.boot + 0.03F;
  const float half = 0.5F * s.width - 0.07F;
  Body body = make_swept({{rear, -s.belt + 0.1F},
                          {front, -s.belt + 0.1F},
                          {front - shape.windscreen, -s.height + 0.03F},
                          {front - shape.windscreen - 0.35F, -s.height},
                          {rear + shape.rear_window, -s.height + 0.02F}},
                         half, 0.27F, -s.belt + 0.1F);
  cut(body, {half - 0.2F, -s.height + 0.01F, 0.0F}, {0.55F, -1.0F, 0.0F});
  cut(body, {-half + 0.2F, -s.height + 0.01F, 0.0F}, {-0.55F, -1.0F, 0.0F});
  return body;
}

Body van_body(const CarShape& shape) {
  const CarStyle& s = shape.style;
  const float front = 0.5F * s.length, rear = -front, half = 0.5F * s.width;
  Body body = make_swept({{rear + 0.1F, -0.24F},
                          {front - 0.15F, -0.24F},
                          {front, -0.5F},
                          {front - 0.06F, -0.95F},
                          {front - shape.bonnet, -s.belt - 0.08F},
                          {front - shape.bonnet - shape.windscreen, -s.height + 0.04F},
                          {rear + shape.rear_window, -s.height},
                          {rear, -0.6F}},
                         half, 0.055F, -0.6F);
  cut(body, {half - 0.1F, -s.height + 0.06F, 0.0F}, {0.8F, -1.0F, 0.0F});
  cut(body, {-half + 0.1F, -s.height + 0.06F, 0.0F}, {-0.8F, -1.0F, 0.0F});
  return body;
}

}  // namespace

Object& add_car(World& world, RandomSequence& random) {
  CarShape shape = pick_shape(random);
  CarStyle& style = shape.style;
  const float longer = random.uniform(-0.12F, 0.15F);
  style.length += longer;
  shape.bonnet += 0.4F * longer;
  style.height += random.uniform(-0.03F, 0.04F);

  Material paint;
  paint.surface = Surface::car_body;
  paint.colour = style.van && random.chance(0.6F) ? Colour(0.82F, 0.82F, 0.80F) : pick_paint(random);
  paint.accent = random.chance(0.5F) ? Colour(0.85F, 0.85F, 0.82F) : Colour(0.80F, 0.66F, 0.12F);
  paint.seed = random.bits();
  paint.car = style;

  std::vector<Body> bodies{style.van ? van_body(shape) : lower_body(shape)};
  bodies[0].material = add_material(world, paint);
  bodies[0].casts_shadow = true;
  if (!style.van) {
    paint.surface = Surface::car_cabin;
    bodies.push_back(cabin(shape));
    bodies[1].material = add_material(world, paint);
    bodies[1].casts_shadow = true;
  }
  Material wheel = paint;
  wheel.surface = Surface::wheel;
  wheel.accent = random.chance(0.7F) ? Colour(0.50F, 0.50F, 0.52F) : Colour(0.16F, 0.16F, 0.17F);
  const int wheel_material = add_material(world, wheel);
  for (const float z : {style.axle_front, style.axle_rear}) {
    for (const float side : {-1.0F, 1.0F}) {
      const Eigen::Vector3f centre(side * (0.5F * style.width - 0.095F), -style.wheel_radius, z);
      bodies.push_back(make_cylinder(centre, 0, style.wheel_radius, 0.21F));
      bodies.back().material = wheel_material;
    }
  }
  // Mirrors.
  for (const float side : {-1.0F, 1.0F}) {
    const float x = side * (0.5F * style.width + 0.06F), z = 0.5F * style.length - shape.bonnet - 0.35F;
    bodies.push_back(make_ellipsoid({x, -style.belt - 0.06F, z}, {0.11F, 0.075F, 0.07F}));
    Material mirror;
    mirror.colour = paint.colour * 0.8F;
    mirror.seed = paint.seed;
    bodies.back().material = add_material(world, mirror);
  }
  Object& object = add_object(world, bodies);
  object.object_class = style.van ? ObjectClass::truck : ObjectClass::car;
  return object;
}

}  // namespace penumbra::slam::synthetic
