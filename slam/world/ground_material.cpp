// The ground and the sky.
#include <cmath>

#include "slam/world/materials.h"

namespace penumbra::slam::synthetic {

namespace {

Colour asphalt(const World& world, const RoadPoint& road, float x, float z, float detail,
               const Eigen::Vector3f& fp) {
  const float coarse = world.texture * fractal_noise(x, z, detail, {5.0F, 2, 0.75F}, world.seed + 100U);
  const float grain = world.texture * fractal_noise(x, z, detail, {0.5F, 7, 1.0F}, world.seed + 110U);
  float tone = 0.12F * std::max(0.2F, 1.0F + 0.12F * coarse + 0.33F * grain);
  // Stones, leaves, chewing gum; stains.
  tone *= std::max(0.3F, 1.0F + 0.6F * world.texture * speckle(x, z, detail, world.seed + 150U));
  // Repairs: darker or lighter fields with sharp edges.
  const float field = value_noise(x * 0.23F, z * 0.31F, world.seed + 120U) +
                      0.25F * value_noise(x * 1.3F, z * 1.1F, world.seed + 121U);
  const float edge = std::max(0.02F, 0.4F * detail);
  tone *= 1.0F - 0.38F * smooth_step(0.50F - edge, 0.50F + edge, field);
  tone *= 1.0F + 0.30F * smooth_step(0.55F - edge, 0.55F + edge, -field);
  // Cracks along the zero line of a noise, near enough to be seen.
  constexpr float kCrack = 0.03F;  // metres
  if (detail < 4.0F * kCrack) {
    const float width = 0.012F + 0.5F * detail;
    const float crack = std::abs(fractal_noise(x, z, 0.1F, {2.3F, 3, 0.6F}, world.seed + 130U));
    const float cracked = smooth_step(-0.2F, 0.3F, value_noise(x * 0.15F, z * 0.15F, world.seed + 131U));
    tone *= 1.0F - 0.55F * std::min(1.0F, kCrack / width) * (1.0F - smooth_step(0.0F, 2.0F * width, crack)) *
                       cracked * band_weight(8.0F * kCrack, detail);
  }
  // Oil and rubber along the wheel tracks.
  const float in_lane = std::abs(std::abs(road.lateral) - kLaneCentre);
  tone *= 1.0F - 0.14F * (1.0F - smooth_step(0.15F, 0.5F, std::abs(in_lane - 0.75F)));
  if (!road.junction) {
    // Covers: a dark disc with a light rim about every 17 m.
    const float cell = std::floor(road.along / 17.0F);
    const std::uint32_t h = hash_of(static_cast<std::uint32_t>(static_cast<int>(cell)), world.seed, 140U);
    const float at = (cell + 0.2F + 0.6F * to_unit(h)) * 17.0F;
    const float side = (to_unit(mix_bits(h)) - 0.5F) * 5.0F;
    const float r = std::hypot(road.along - at, road.lateral - side);
    const float soft = std::max(0.015F, detail);
    tone = mix(tone, 0.07F + 0.03F * std::sin(40.0F * road.along) * band_weight(0.16F, detail),
               1.0F - smooth_step(0.33F - soft, 0.33F + soft, r));
    tone = mix(tone, 0.24F, pulse(r, 0.31F, 0.36F, soft) * 0.7F);
  }
  Colour colour = Colour(1.0F, 0.985F, 0.96F) * tone;
  if (!road.junction) {
    const float lateral = std::abs(road.lateral);
    // Pixel widths across and along the road: the footprint turned into the road's axes is between the two.
    const float across = std::min(fp.x(), fp.z()) + 0.1F * std::max(fp.x(), fp.z());
    const float dash = std::fmod(road.along, 9.0F), bay = std::fmod(road.along, 6.0F);
    float paint = pulse(lateral, -0.07F, 0.07F, across) * pulse(dash, 0.0F, 4.0F, detail);
    paint +=
        pulse(lateral, kParkingLine - 0.06F, kParkingLine + 0.06F, across) * pulse(bay, 0.0F, 1.2F, detail);
    const float worn = 0.8F - 0.35F * clamp01(0.4F + grain + 0.5F * coarse);
    colour = blend(colour, Colour(0.72F, 0.72F, 0.69F), clamp01(paint) * worn);
  }
  return colour;
}

Colour pavement(const World& world, const RoadPoint& road, float x, float z, float detail) {
  const float grain = world.texture * fractal_noise(x, z, detail, {1.5F, 8, 0.95F}, world.seed + 200U);
  const float dirt = 0.4F * speckle(x, z, detail, world.seed + 240U);
  // Slabs of 0.5 m, every second row shifted by half a slab.
  const float row = road.along / 0.5F, row_number = std::floor(row);
  const float shift = (static_cast<int>(row_number) & 1) != 0 ? 0.5F : 0.0F;
  const float column = road.lateral / 0.5F + shift, column_number = std::floor(column);
  const float tone =
      to_unit(hash_of(static_cast<std::uint32_t>(static_cast<int>(row_number)),
                      static_cast<std::uint32_t>(static_cast<int>(column_number)), world.seed));
  const float visible = band_weight(0.5F, detail);
  float value = 0.30F * (1.0F + visible * 0.5F * (tone - 0.5F) + 0.22F * grain + world.texture * dirt);
  const float joint = 0.012F, width = std::max(detail / 0.5F, 0.01F);
  const float u = row - row_number, v = column - column_number;
  const float gap = pulse(u, 0.0F, 2.0F * joint, width) + pulse(v, 0.0F, 2.0F * joint, width);
  value *= 1.0F - 0.55F * std::min(gap, 1.0F) * visible;
  return Colour(1.0F, 0.96F, 0.90F) * value;
}

}  // namespace

Appearance ground_appearance(const World& world, const SurfacePoint& point) {
  const float x = point.position.x(), z = point.position.z(), detail = point.detail(0, 2);
  const RoadPoint road = world.road_map.at(x, z);
  const float d = road.distance;
  const float soft = std::max(0.02F, detail);
  Appearance look;
  if (d < kKerb + soft) {
    look.albedo = asphalt(world, road, x, z, detail, point.footprint);
    look.gloss = 0.015F;
  }
  if (d > kKerb - 0.25F - soft) {
    // Gutter and kerbstones of one metre.
    const float grain = world.texture * fractal_noise(x, z, detail, {0.5F, 5, 0.8F}, world.seed + 210U);
    const float joint = pulse(std::fmod(road.along, 1.0F), 0.0F, 0.025F, detail);
    const Colour gutter = Colour(0.085F, 0.082F, 0.078F) * (1.0F + 0.3F * grain);
    const Colour stone = Colour(0.40F, 0.385F, 0.36F) * (1.0F + 0.2F * grain) * (1.0F - 0.5F * joint);
    if (d < kKerb + soft)
      look.albedo = blend(look.albedo, gutter, smooth_step(kKerb - 0.25F - soft, kKerb - 0.25F + soft, d));
    const float slabs = smooth_step(kKerb + 0.16F - soft, kKerb + 0.16F + soft, d);
    const Colour beyond = slabs > 0.0F ? blend(stone, pavement(world, road, x, z, detail), slabs) : stone;
    look.albedo = blend(look.albedo, beyond, smooth_step(kKerb - soft, kKerb + soft, d));
  }
  if (d > kPavementEnd - soft) {
    const float blades = world.texture * fractal_noise(x, z, detail, {1.0F, 7, 1.0F}, world.seed + 220U);
    const float dry = smooth_step(0.0F, 0.8F, value_noise(x * 0.2F, z * 0.2F, world.seed + 230U));
    const Colour grass = blend(Colour(0.075F, 0.135F, 0.035F), Colour(0.19F, 0.17F, 0.09F), dry) *
                         std::max(0.25F, 1.0F + 0.5F * blades);
    look.albedo = blend(look.albedo, grass, smooth_step(kPavementEnd - soft, kPavementEnd + soft, d));
  }
  look.albedo = look.albedo.cwiseMax(0.01F);
  return look;
}

Colour sky_light(const World& world, const Eigen::Vector3f& direction, float angular_footprint) {
  const float up = -direction.y();
  const float azimuth = std::atan2(direction.x(), direction.z());
  // Hills and tree tops around the horizon.
  const float ridge =
      0.035F + 0.022F * value_noise(azimuth * 5.0F, 0.0F, world.seed + 300U) +
      0.012F * fractal_noise(azimuth, 0.0F, angular_footprint, {0.06F, 4, 0.7F}, world.seed + 310U);
  const float soft = std::max(angular_footprint, 1e-3F);
  const float height = clamp01(up);
  Colour sky = blend(Colour(0.80F, 0.85F, 0.90F), Colour(0.30F, 0.47F, 0.76F), std::sqrt(height));
  sky = blend(sky, Colour(0.74F, 0.77F, 0.80F), 0.8F * world.clouds).cwiseProduct(world.sky_tint);
  if (up > 0.02F) {
    // Clouds in a plane high above.
    const float scale = 1.0F / (up + 0.15F);
    const float cover = fractal_noise(direction.x() * scale, direction.z() * scale,
                                      angular_footprint * scale * scale, {1.4F, 5, 0.55F}, world.seed + 320U);
    const Colour cloud = blend(Colour(0.98F, 0.97F, 0.95F), Colour(0.52F, 0.55F, 0.60F), world.clouds);
    sky = blend(sky, cloud.cwiseProduct(world.sky_tint), 0.85F * smooth_step(-0.05F, 0.75F, cover));
  }
  const float sun = std::max(0.0F, direction.dot(world.to_sun));
  sky += world.sun_colour * (0.25F * std::pow(sun, 24.0F) * (1.0F - world.clouds));
  const float leaves = fractal_noise(azimuth, up, angular_footprint, {0.04F, 5, 0.85F}, world.seed + 330U);
  const Colour hills = Colour(0.30F, 0.37F, 0.36F) * (1.0F + 0.22F * leaves);
  return blend(hills, sky, smooth_step(ridge - soft, ridge + soft, up));
}

}  // namespace penumbra::slam::synthetic
