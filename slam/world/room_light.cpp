// Light in a room: diffuse light from its lamps and windows, patches of sun behind the windows, the mirror
// image of the room in what is glossy.
//
//   L = albedo (E_ceiling + E_windows + E_sun) + fresnel L_room(mirrored ray) + glow
//
// E_ceiling grows with the share of the ceiling that the surface faces, E_windows falls with the distance
// from the window wall. Below the tops of desks there is less of both. Nothing else throws shadows: people
// are lit as if alone.
#include <cmath>

#include "slam/world/materials.h"

namespace penumbra::slam::synthetic {

namespace {

// 1 where the ray from `p` towards the sun leaves through a pane, with soft edges.
float through_window(const Room& room, const Eigen::Vector3f& p, const Eigen::Vector3f& to_sun) {
  if (room.windows == 0 || to_sun.x() > -0.05F) return 0.0F;
  const float t = (room.lower.x() - p.x()) / to_sun.x();
  const float y = p.y() + t * to_sun.y(), z = p.z() + t * to_sun.z();
  const float soft = 0.01F + 0.01F * t;  // the sun is no point
  const float height = pulse(y, room.window_top, room.window_bottom, soft);
  if (height <= 0.0F) return 0.0F;
  const float place = (z - room.window_first) / room.window_step;
  const int pane = floor_int(place);
  if (pane < 0 || pane >= room.windows) return 0.0F;
  const float u = (place - static_cast<float>(pane)) * room.window_step;
  return height * pulse(u, 0.0F, room.window_width, soft);
}

// Share of the light from above that desks leave to a point.
float beneath_desks(const Room& room, const Eigen::Vector3f& p) {
  float open = 1.0F;
  for (const Shelter& desk : room.shelters) {
    if (p.y() < desk.y + 0.01F) continue;
    const Eigen::Vector2f from = desk.to_local * Eigen::Vector2f(p.x() - desk.x, p.z() - desk.z);
    const float fade = 0.05F + 0.25F * (p.y() - desk.y);  // farther below the edge blurs
    const float inside = clamp01((desk.half_x - std::abs(from.x())) / fade + 0.5F) *
                         clamp01((desk.half_z - std::abs(from.y())) / fade + 0.5F);
    open *= 1.0F - 0.6F * inside;
  }
  return open;
}

// What a ray inside the room meets, roughly: lamps, panes, walls, floor.
Colour seen_in_mirror(const World& world, const Eigen::Vector3f& p, const Eigen::Vector3f& ray) {
  const Room& room = *world.room;
  float nearest = 1e9F;
  int axis = 0;
  for (int i = 0; i < 3; ++i) {
    const float wall = ray[i] > 0.0F ? room.upper[i] : room.lower[i];
    const float t = std::abs(ray[i]) > 1e-4F ? (wall - p[i]) / ray[i] : 1e9F;
    if (t < nearest) {
      nearest = t;
      axis = i;
    }
  }
  const Eigen::Vector3f hit = p + nearest * ray;
  if (axis == 1) {
    if (ray.y() > 0.0F) return Colour::Constant(0.12F);
    for (const Eigen::Vector2f& lamp : room.lamps) {
      if (std::abs(hit.x() - lamp.x()) < Room::kLampHalfX && std::abs(hit.z() - lamp.y()) < Room::kLampHalfZ)
        return Colour(2.2F, 2.15F, 2.0F);
    }
    return Colour::Constant(0.45F);
  }
  if (axis == 0 && ray.x() < 0.0F && through_window(room, p, ray) > 0.5F) return Colour(1.5F, 1.6F, 1.7F);
  return Colour::Constant(0.30F + 0.12F * value_noise(1.3F * hit.x() + hit.z(), 1.3F * hit.y(), world.seed));
}

}  // namespace

Colour room_light(const World& world, const Appearance& look, const Eigen::Vector3f& position,
                  const Eigen::Vector3f& normal, const Eigen::Vector3f& view, float* sunlight) {
  const Room& room = *world.room;
  const float up = 0.5F - 0.5F * normal.y();
  const float towards_windows = 0.5F - 0.5F * normal.x();
  const float away = position.x() - room.lower.x();
  const float near_window = room.windows > 0 ? 1.0F / (1.0F + 0.12F * away * away) : 0.0F;
  const float low = 0.7F + 0.3F * clamp01(-position.y() / 0.5F);
  const float open = beneath_desks(room, position);
  Colour irradiance =
      Colour(1.0F, 0.98F, 0.93F) * (room.lamp_light * (0.30F + 0.70F * up) * low * open) +
      world.sky_colour * (near_window * (0.15F + 0.85F * towards_windows) * mix(0.6F, 1.0F, open));
  float sun = 0.0F;
  if (room.sunny) {
    const float lambert = normal.dot(world.to_sun);
    if (lambert > 0.0F)
      sun = lambert * through_window(room, position, world.to_sun) * (open > 0.75F ? 1.0F : 0.0F);
  }
  irradiance += world.sun_colour * sun;
  if (sunlight != nullptr) *sunlight = sun;
  Colour light = look.albedo.cwiseProduct(irradiance) + look.glow;
  if (look.gloss > 0.0F) {
    const float facing = clamp01(-normal.dot(view)), grazing = 1.0F - facing;
    const float g2 = grazing * grazing;
    const float fresnel = look.gloss + 0.6F * (1.0F - look.gloss) * g2 * g2 * grazing;
    light += seen_in_mirror(world, position, view + 2.0F * facing * normal) * fresnel;
  }
  return light;
}

}  // namespace penumbra::slam::synthetic
