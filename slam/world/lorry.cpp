// Lorries: their shape and the painter of cab and box.
#include <cmath>

#include "slam/world/materials.h"
#include "slam/world/object_parts.h"
#include "slam/world/street_objects.h"

namespace penumbra::slam::synthetic {

namespace {

constexpr float kDeck = 1.0F;  // height of the box's floor, metres

// Lettering: words of random strokes, `size` metres high, in the band of heights from `bottom` on.
float lettering(float x, float height, float bottom, float size, float detail, std::uint32_t seed) {
  const float row = (height - bottom) / size;
  if (row < 0.0F || row > 1.0F) return 0.0F;
  const float column = x / (0.62F * size), number = std::floor(column);
  const std::uint32_t letter = hash_of(static_cast<std::uint32_t>(static_cast<int>(number) + 1000), seed);
  if (letter % 7U == 0U) return 0.0F;  // a gap between words
  // Every letter picks some of seven strokes, as a display does.
  const float u = column - number, width = detail / (0.62F * size), tall = detail / size;
  const auto upright = [&](float at, float low, float high) {
    return pulse(u, at, at + 0.16F, width) * pulse(row, low, high, tall);
  };
  const auto level = [&](float at) {
    return pulse(u, 0.12F, 0.80F, width) * pulse(row, at, at + 0.14F, tall);
  };
  const float strokes[] = {upright(0.12F, 0.0F, 0.5F),
                           upright(0.12F, 0.5F, 1.0F),
                           upright(0.64F, 0.0F, 0.5F),
                           upright(0.64F, 0.5F, 1.0F),
                           level(0.0F),
                           level(0.43F),
                           level(0.86F)};
  float ink = 0.0F;
  for (int i = 0; i < 7; ++i) {
    if (((letter >> (8 + i)) & 1U) != 0U || i == 0) ink = std::max(ink, strokes[i]);
  }
  return ink * band_weight(0.5F * size, detail);
}

}  // namespace

Appearance lorry_appearance(const Material& material, const Body& body, const SurfacePoint& point) {
  const Eigen::Vector3f &p = point.position, &n = point.normal;
  const bool side = std::abs(n.x()) > 0.7F, rear = n.z()<-0.7F, front = n.z()> 0.45F;
  const int across = side ? 2 : 0, up = std::abs(n.y()) > 0.7F ? 2 : 1;
  const float x = p[across], height = -p.y(), detail = point.detail(across, up);
  const float wu = point.footprint[across], wv = point.footprint[up];
  const float low = -body.upper.y(), high = -body.lower.y();
  const float grime = point.texture * fractal_noise(x, p[up], detail, {1.2F, 8, 0.95F}, material.seed);
  Appearance look;
  look.albedo = material.colour *
                std::max(0.3F, 1.0F + 0.14F * grime +
                                   0.2F * point.texture * speckle(x, p[up], detail, material.seed + 9U));
  look.gloss = 0.03F;
  const bool cab = body.lower.z() > 0.0F;
  if (cab) {
    const float top = high - 0.35F, sill = high - 1.25F;
    float glass = 0.0F;
    if (front)
      glass = pulse(height, sill, top, wv) * pulse(x, body.lower.x() + 0.12F, body.upper.x() - 0.12F, wu);
    if (side)
      glass = pulse(height, sill, top, wv) * pulse(x, body.upper.z() - 1.05F, body.upper.z() - 0.25F, wu);
    const Colour pane = Colour(0.04F, 0.045F, 0.05F) *
                        (1.0F + 0.7F * fractal_noise(x, height, detail, {0.6F, 4, 0.8F}, material.seed + 3U));
    look.albedo = blend(look.albedo, pane, glass);
    look.gloss = mix(look.gloss, 0.12F, glass);
    if (front) {
      const float grille = pulse(x, -0.7F, 0.7F, wu) * pulse(height, 0.75F, 1.25F, wv);
      look.albedo = blend(look.albedo, Colour::Constant(0.03F),
                          grille * (0.7F + 0.3F * std::sin(60.0F * height) * band_weight(0.1F, wv)));
      const float lamp = pulse(std::abs(x), body.upper.x() - 0.45F, body.upper.x() - 0.1F, wu);
      look.albedo = blend(look.albedo, Colour::Constant(0.8F), lamp * pulse(height, 0.6F, 0.85F, wv));
    }
    return look;
  }
  // The box: a band of colour, lettering, dirt thrown up from the road.
  const float middle = mix(low, high, 0.55F);
  if (side || rear) {
    const float wave = 0.12F * std::sin(1.3F * x + static_cast<float>(material.seed % 7U));
    const float band = pulse(height + wave, middle - 0.55F, middle - 0.42F, wv) +
                       pulse(height, low, low + 0.12F, wv) + pulse(height, high - 0.1F, high, wv);
    look.albedo = blend(look.albedo, material.accent, clamp01(band) * 0.9F);
    const float along = side && n.x() < 0.0F ? -x : x;  // to the right as one reads
    const float ink =
        std::max(lettering(along, height, middle - 0.25F, side ? 0.8F : 0.45F, detail, material.seed),
                 lettering(along, height, middle - 0.95F, 0.22F, detail, material.seed + 1U));
    look.albedo = blend(look.albedo, material.accent * 0.8F, ink * 0.9F);
    look.albedo = blend(look.albedo, Colour(0.20F, 0.17F, 0.13F) * (1.0F + 0.4F * grime),
                        clamp01(0.55F + 0.6F * grime) * 0.7F * clamp01((low + 1.1F - height) / 1.1F));
  }
  if (side) {
    // A tarpaulin with straps: folds run down from them.
    const float fold = std::sin(7.5F * x + 0.6F * grime) * band_weight(0.8F, detail);
    look.albedo *= 1.0F + 0.10F * fold;
    const float strap = std::abs(x / 0.6F - std::round(x / 0.6F)) * 0.6F;
    look.albedo = blend(look.albedo, Colour::Constant(0.05F),
                        pulse(strap, -0.02F, 0.02F, wu) * pulse(height, low, low + 0.5F, wv));
  } else if (rear) {
    // Two doors with locking bars and hinges, warning stripes at the foot.
    const float a = std::abs(x), half = body.upper.x();
    float metal = 0.0F;
    for (const float at : {0.28F * half, 0.72F * half}) {
      metal += pulse(a, at - 0.018F, at + 0.018F, wu);
      metal += pulse(a, at - 0.10F, at + 0.10F, wu) * pulse(height, low + 0.45F, low + 0.52F, wv);
    }
    for (const float share : {0.12F, 0.4F, 0.68F, 0.92F}) {
      metal += pulse(a, half - 0.16F, half - 0.02F, wu) *
               pulse(height, mix(low, high, share), mix(low, high, share) + 0.09F, wv);
    }
    look.albedo = blend(look.albedo, Colour::Constant(0.30F) * (1.0F + 0.4F * grime), clamp01(metal));
    look.albedo *= 1.0F - 0.75F * pulse(x, -0.012F, 0.012F, wu);
    const float stripe = std::sin(22.0F * (x + height)) > 0.0F ? 1.0F : 0.0F;
    look.albedo = blend(look.albedo, blend(Colour(0.75F, 0.72F, 0.66F), Colour(0.6F, 0.04F, 0.03F), stripe),
                        pulse(height, low + 0.14F, low + 0.28F, wv) * 0.9F * band_weight(0.28F, detail));
  }
  return look;
}

Object& add_lorry(World& world, RandomSequence& random) {
  const float length = random.uniform(6.6F, 8.4F);
  return add_lorry(world, random, {length, 2.4F, random.uniform(3.5F, 3.8F)});
}

Object& add_lorry(World& world, RandomSequence& random, const LorrySize& size) {
  static const Colour kBoxes[] = {{0.72F, 0.72F, 0.70F}, {0.10F, 0.16F, 0.34F}, {0.50F, 0.08F, 0.06F},
                                  {0.62F, 0.50F, 0.16F}, {0.14F, 0.30F, 0.18F}, {0.45F, 0.45F, 0.46F}};
  const auto pick = [&] { return kBoxes[random.below(static_cast<int>(std::size(kBoxes)))]; };
  const float height = size.height, front = 0.5F * size.length, rear = -front, half = 0.5F * size.width;
  Material box;
  box.surface = Surface::lorry;
  box.colour = pick();
  box.accent = box.colour.sum() > 1.6F ? Colour(0.08F, 0.12F, 0.30F) : Colour(0.78F, 0.76F, 0.70F);
  box.seed = random.bits();
  Material cab = box;
  cab.colour = pick();
  Material wheel = box;
  wheel.surface = Surface::wheel;
  wheel.accent = Colour::Constant(0.35F);
  wheel.car.wheel_radius = 0.48F;
  const int box_material = add_material(world, box), cab_material = add_material(world, cab);
  const int wheel_material = add_material(world, wheel);
  const int frame = plain_material(world, random, Colour::Constant(0.04F));
  const int lamp = plain_material(world, random, Colour(0.5F, 0.03F, 0.02F));

  std::vector<Body> bodies;
  bodies.push_back(
      with_material(make_box({-half, -height, rear}, {half, -kDeck, front - 1.95F}), box_material));
  const float roof = height - 0.75F;
  bodies.push_back(with_material(make_swept({{front - 1.85F, -0.5F},
                                             {front - 0.05F, -0.5F},
                                             {front, -1.2F},
                                             {front - 0.25F, -roof},
                                             {front - 1.85F, -roof - 0.1F}},
                                            half - 0.05F),
                                 cab_material));
  bodies[0].casts_shadow = bodies[1].casts_shadow = true;
  bodies.push_back(with_material(
      make_box({-half + 0.25F, -kDeck, rear + 0.1F}, {half - 0.25F, -0.62F, front - 1.0F}), frame));
  bodies.push_back(
      with_material(make_box({-half + 0.05F, -0.66F, rear}, {half - 0.05F, -0.46F, rear + 0.12F}), frame));
  for (const float side : {-1.0F, 1.0F}) {
    bodies.push_back(with_material(
        shifted(make_box({-0.22F, -0.92F, rear - 0.02F}, {0.22F, -0.74F, rear + 0.1F}), side * (half - 0.3F)),
        lamp));
    for (const float z : {front - 1.15F, rear + 1.7F}) {
      bodies.push_back(
          with_material(make_cylinder({side * (half - 0.2F), -0.48F, z}, 0, 0.48F, 0.32F), wheel_material));
    }
  }
  Object& object = add_object(world, bodies);
  object.object_class = ObjectClass::truck;
  return object;
}

}  // namespace penumbra::slam::synthetic
