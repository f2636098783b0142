// Cars, leaves, bark, cloth, signs and plain surfaces.
#include <cmath>
#include <limits>

#include "slam/world/materials.h"

namespace penumbra::slam::synthetic {

namespace {

// Distance from a point of face `face` to the nearest of the body's other faces that meet it at an edge.
float edge_distance(const Body& body, int face, const Eigen::Vector3f& p) {
  float nearest = std::numeric_limits<float>::max();
  for (int i = 0; i < body.plane_count; ++i) {
    if (i == face) continue;
    const Plane& plane = body.planes[static_cast<std::size_t>(i)];
    nearest = std::min(nearest, -(plane.normal.dot(p) + plane.offset));
  }
  return nearest;
}

Colour number_plate(const Material& material, float x, float y, float wu, float wv) {
  // Eight characters as dark fields of random strokes.
  const float column = (x + 0.24F) / 0.06F, row = y / 0.025F;
  const std::uint32_t h =
      hash_of(static_cast<std::uint32_t>(static_cast<int>(std::floor(column * 2.0F)) + 64),
              static_cast<std::uint32_t>(static_cast<int>(std::floor(row)) + 64), material.seed);
  const float ink = (h & 1U) != 0U ? band_weight(0.06F, std::max(wu, wv)) : 0.0F;
  const float within = pulse(x, -0.22F, 0.22F, wu) * pulse(y, 0.02F, 0.09F, wv);
  return blend(material.accent, Colour::Constant(0.03F), 0.85F * ink * within);
}

}  // namespace

Appearance car_appearance(const Material& material, const Body& body, int face, const SurfacePoint& point) {
  const CarStyle& style = material.car;
  const Eigen::Vector3f& p = point.position;
  const Eigen::Vector3f& n = point.normal;
  int a = 0, b = 1;
  drawing_axes(n, a, b);
  const float detail = point.detail(a, b), height = -p.y(), half_length = 0.5F * style.length;
  const float wu = point.footprint[a], wv = std::max(point.footprint.y(), 0.3F * wu);
  const bool side = std::abs(n.x()) > 0.75F, front = n.z() > 0.45F && height < style.belt + 0.02F;
  const bool rear = n.z() < -0.6F;
  const float grime = point.texture * fractal_noise(p[a], p[b], detail, {0.8F, 7, 0.8F}, material.seed);

  Appearance look;
  look.albedo = material.colour * (1.0F + 0.06F * grime);
  look.albedo = blend(look.albedo, Colour(0.22F, 0.19F, 0.15F),
                      clamp01(0.5F + 0.5F * grime) * 0.45F * clamp01((0.6F - height) / 0.4F));
  look.gloss = 0.09F;

  const bool cabin = material.surface == Surface::car_cabin;
  bool glazed = cabin && n.y() > -0.86F;
  float border = cabin ? edge_distance(body, face, p) : 0.0F;
  if (style.van) {
    const bool windscreen = n.z() > 0.5F && height > style.belt + 0.1F;
    const bool door_window = side && height > style.belt + 0.05F && height < style.height - 0.3F &&
                             p.z() > half_length - 2.2F && p.z() < half_length - 1.25F;
    const bool rear_window =
        rear && height > style.belt + 0.15F && height < style.height - 0.25F && std::abs(p.x()) < 0.72F;
    glazed = windscreen || door_window || rear_window;
    border = windscreen ? edge_distance(body, face, p) : 0.1F;
  }
  if (glazed) {
    const float soft = std::max(0.5F * detail, 0.004F);
    float glass = smooth_step(0.045F - soft, 0.045F + soft, border);
    if (side && cabin) glass *= 1.0F - pulse(p.z(), -0.10F, 0.0F, wu);  // pillar between the doors
    glass *= clamp01((height - style.belt - 0.02F) / std::max(wv, 0.01F) + 0.5F);
    // Seats and the street mirrored in the window.
    const float seats = fractal_noise(p[a], p[b], detail, {0.5F, 4, 0.8F}, material.seed + 31U);
    const float mirrored =
        fractal_noise(p.x() + p.z(), 2.0F * p.y(), detail, {0.9F, 4, 0.7F}, material.seed + 33U);
    Colour pane = Colour(0.035F, 0.040F, 0.042F) * (1.0F + 0.5F * seats);
    pane += Colour(0.09F, 0.11F, 0.13F) * smooth_step(0.2F, 0.9F, mirrored);
    look.albedo = blend(look.albedo, pane, glass);
    look.gloss = mix(look.gloss, 0.13F, glass);
    return look;
  }
  if (cabin) return look;

  if (side) {
    for (const float axle : {style.axle_front, style.axle_rear}) {
      const float r = std::hypot(p.z() - axle, height - style.wheel_radius);
      const float arch = 1.0F - clamp01((r - style.wheel_radius - 0.055F) / std::max(detail, 0.005F) + 0.5F);
      look.albedo = blend(look.albedo, Colour::Constant(0.012F), arch);
      look.gloss *= 1.0F - arch;
    }
    // Door seams, handles, sill, a protective strip.
    float seam = 0.0F;
    for (const float z : {0.92F, -0.06F, -0.98F}) seam += pulse(p.z(), z - 0.012F, z + 0.012F, wu);
    seam *= pulse(height, 0.30F, style.belt - 0.02F, wv);
    seam += pulse(height, 0.18F, 0.29F, wv) * 0.9F + 0.55F * pulse(height, 0.50F, 0.545F, wv);
    for (const float z : {0.08F, -0.84F}) {
      seam +=
          0.8F * pulse(p.z(), z, z + 0.17F, wu) * pulse(height, style.belt - 0.16F, style.belt - 0.125F, wv);
    }
    look.albedo = blend(look.albedo, Colour::Constant(0.02F), clamp01(seam) * 0.85F);
  } else if (front || rear) {
    const float x = std::abs(p.x()), half = 0.5F * style.width;
    const float light_low = front ? 0.57F : (style.van ? 0.75F : 0.68F),
                light_high = front ? 0.73F : (style.van ? 1.15F : 0.88F);
    const float lamp =
        pulse(x, half - (front ? 0.46F : 0.30F), half - 0.06F, wu) * pulse(height, light_low, light_high, wv);
    const float facets = 0.75F + 0.25F * std::sin(p.x() * 90.0F) * band_weight(0.07F, detail);
    const Colour lamp_colour = front ? Colour(0.85F, 0.87F, 0.88F) : Colour(0.55F, 0.03F, 0.02F);
    look.albedo = blend(look.albedo, lamp_colour * facets, lamp);
    // Bumper line and grille.
    float dark = 0.9F * pulse(height, 0.18F, 0.30F, wv) + 0.4F * pulse(height, 0.525F, 0.55F, wv);
    if (front)
      dark += pulse(x, -0.5F, 0.5F, wu) * pulse(height, 0.58F, 0.70F, wv) *
              (0.7F + 0.3F * std::sin(height * 250.0F) * band_weight(0.025F, wv));
    look.albedo = blend(look.albedo, Colour::Constant(0.02F), clamp01(dark));
    const float plate = pulse(p.x(), -0.26F, 0.26F, wu) * pulse(height, 0.36F, 0.47F, wv);
    look.albedo = blend(look.albedo, number_plate(material, p.x(), height - 0.36F, wu, wv), plate);
    look.gloss *= 1.0F - plate;
    if (!front && !style.van) {
      const float lid = pulse(height, 0.60F, 0.615F, wv) * pulse(x, 0.0F, half - 0.1F, wu);
      look.albedo *= 1.0F - 0.6F * lid;
    }
  } else if (n.y() < -0.5F) {
    // Bonnet and boot: seams near the edges of the lids.
    const float border_x =
        pulse(std::abs(p.x()), 0.5F * style.width - 0.17F, 0.5F * style.width - 0.155F, wu);
    look.albedo *= 1.0F - 0.5F * border_x;
  }
  return look;
}

Appearance wheel_appearance(const Material& material, const Body& body, int face, const SurfacePoint& point) {
  Appearance look;
  look.albedo = Colour::Constant(0.022F);
  const float dz = point.position.z() - body.centre.z(), dy = point.position.y() - body.centre.y();
  const float r = std::hypot(dz, dy), tyre = material.car.wheel_radius, detail = point.detail(1, 2);
  if (face == 15) {  // the tread
    look.albedo *= 1.0F + 0.6F * std::sin(point.position.x() * 200.0F) * band_weight(0.03F, detail);
    return look;
  }
  const float rim = 1.0F - clamp01((r - 0.70F * tyre) / std::max(detail, 0.004F) + 0.5F);
  const int spokes = 5 + static_cast<int>(material.seed % 4U);
  const float turn = std::atan2(dy, dz) * static_cast<float>(spokes);
  const float spoke = smooth_step(-0.3F, 0.3F, std::cos(turn)) * band_weight(0.12F, detail) +
                      0.5F * (1.0F - band_weight(0.12F, detail));
  const float hub = 1.0F - clamp01((r - 0.22F * tyre) / std::max(detail, 0.004F) + 0.5F);
  const float outer = pulse(r, 0.60F * tyre, 0.70F * tyre, detail);
  const float metal = clamp01(std::max({spoke, hub, outer}));
  look.albedo = blend(look.albedo, blend(Colour::Constant(0.03F), material.accent, metal), rim);
  look.gloss = 0.05F * rim * metal;
  return look;
}

Appearance plain_appearance(const Material& material, const SurfacePoint& point) {
  int a = 0, b = 1;
  drawing_axes(point.normal, a, b);
  const float detail = point.detail(a, b);
  const Eigen::Vector3f& p = point.position;
  Appearance look;
  switch (material.surface) {
    case Surface::leaves: {
      const float clumps =
          point.texture * fractal_noise(p.x(), p.y(), p.z(), detail, {0.4F, 5, 1.1F}, material.seed);
      const float light = smooth_step(-0.9F, 1.1F, clumps);
      look.albedo = material.colour * (0.15F + 1.9F * light);
      look.albedo.x() += 0.04F * light * light;
      break;
    }
    case Surface::bark: {
      const float around = std::atan2(p.x(), p.z()) * 0.3F;
      const float ridges =
          point.texture * fractal_noise(around * 3.0F, 0.4F * p.y(), detail, {0.4F, 6, 0.85F}, material.seed);
      look.albedo = material.colour * std::max(0.2F, 1.0F + 0.5F * ridges);
      break;
    }
    case Surface::cloth: {
      const float folds =
          point.texture * fractal_noise(p.x(), 0.5F * p.y(), p.z(), detail, {0.3F, 5, 0.8F}, material.seed);
      look.albedo = material.colour * (1.0F + 0.35F * folds);
      break;
    }
    case Surface::sign: {
      const float x = p.x(), y = p.y(), soft = std::max(detail, 0.004F);
      if (point.normal.z() > -0.5F) {
        look.albedo = Colour::Constant(0.30F);
        break;
      }
      const float glyph = fractal_noise(x, y, 0.02F, {0.22F, 2, 0.6F}, material.seed);
      const float inner = clamp01(0.5F - (std::abs(x) - 0.22F) / soft);
      look.albedo =
          blend(material.colour, Colour::Constant(0.78F), inner * smooth_step(-0.02F, 0.06F, glyph));
      look.gloss = 0.02F;
      break;
    }
    default: {
      const float noise = point.texture * fractal_noise(p[a], p[b], detail, {1.0F, 8, 0.95F}, material.seed);
      look.albedo = material.colour * std::max(0.2F, 1.0F + 0.28F * noise);
      look.gloss = 0.01F;
    }
  }
  return look;
}

}  // namespace penumbra::slam::synthetic
