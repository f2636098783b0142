// Facades with windows and doors, roofs.
#include <cmath>

#include "slam/world/materials.h"

namespace penumbra::slam::synthetic {

namespace {

Colour wall_colour(const Material& material, float u, float height, float detail, float texture) {
  const float patina = fractal_noise(u, height, detail, {0.6F, 7, 1.0F}, material.seed) +
                       0.7F * value_noise(0.5F * u, 0.5F * height, material.seed + 30U);
  // Rain leaves streaks: noise stretched in height.
  const float streaks = fractal_noise(u, 0.15F * height, detail, {0.5F, 3, 0.8F}, material.seed + 20U);
  // Chipped plaster, damp patches.
  const float damage = 0.33F * speckle(u, height, detail, material.seed + 40U);
  Colour colour =
      material.colour * std::max(0.2F, 1.0F + texture * (0.19F * patina + 0.08F * streaks + damage));
  if (material.facade.brick) {
    constexpr float kCourse = 0.075F, kBrick = 0.24F;
    const float visible = band_weight(0.15F, detail);
    if (visible > 0.0F) {
      const float row = height / kCourse, row_number = std::floor(row);
      const float column = u / kBrick + ((static_cast<int>(row_number) & 1) != 0 ? 0.5F : 0.0F);
      const float column_number = std::floor(column);
      const float tone =
          to_unit(hash_of(static_cast<std::uint32_t>(static_cast<int>(row_number)),
                          static_cast<std::uint32_t>(static_cast<int>(column_number)), material.seed));
      const float mortar = std::min(1.0F, pulse(row - row_number, 0.0F, 0.14F, detail / kCourse) +
                                              pulse(column - column_number, 0.0F, 0.045F, detail / kBrick));
      colour *= 1.0F + visible * (0.9F * (tone - 0.5F));
      colour = blend(colour, Colour(0.50F, 0.47F, 0.43F), 0.75F * visible * mortar);
    }
  }
  return colour;
}

}  // namespace

Appearance facade_appearance(const Material& material, const Body& body, const SurfacePoint& point) {
  const FacadeStyle& style = material.facade;
  const bool front_or_back = std::abs(point.normal.x()) > 0.5F;
  const int axis = front_or_back ? 2 : 0;
  const float u = point.position[axis] - body.lower[axis], height = -point.position.y();
  const float length = body.upper[axis] - body.lower[axis], top = -body.lower.y();
  const float wu = point.footprint[axis], wv = point.footprint.y(), detail = point.detail(axis, 1);

  Appearance look;
  look.albedo = wall_colour(material, u + (point.normal.x() + 2.0F * point.normal.z()) * 31.0F, height,
                            detail, point.texture);
  // Plinth, a ledge between storeys, a cornice below the roof.
  const float storey = std::floor(height / style.storey);
  const float in_storey = height - storey * style.storey;
  const float plinth = 1.0F - clamp01((height - 0.55F) / std::max(wv, 0.01F) + 0.5F);
  look.albedo = blend(look.albedo, look.albedo * 0.62F, plinth);
  const float ledge = storey >= 1.0F ? pulse(in_storey, 0.0F, 0.13F, wv) : 0.0F;
  look.albedo = blend(look.albedo, Colour(0.62F, 0.60F, 0.56F), 0.6F * ledge);
  look.albedo *= 1.0F - 0.35F * pulse(in_storey, -0.05F, 0.0F, wv) * (storey >= 1.0F ? 1.0F : 0.0F);
  look.albedo *= 1.0F - 0.45F * clamp01((height - top + 0.35F) / 0.35F);  // shade of the eaves

  // Side walls have a few windows only, the back none.
  const float columns =
      front_or_back ? std::round(length / style.column) : std::floor(length / (2.0F * style.column));
  if (columns < 1.0F || point.normal.x() > 0.5F) return look;
  const float spacing = length / columns;
  const float column = std::min(std::floor(u / spacing), columns - 1.0F);
  const float x = u - (column + 0.5F) * spacing;  // from the middle of the column
  const bool ground_floor = storey < 1.0F;
  const bool front = point.normal.x() < -0.5F;
  const bool door = front && ground_floor && static_cast<int>(column) == style.door_column;
  const bool shop = front && ground_floor && style.shop && !door;
  float half = 0.5F * style.window_width, bottom = style.sill, upper = style.sill + style.window_height;
  if (door) {
    half = 0.55F;
    bottom = 0.1F;
    upper = 2.25F;
  } else if (shop) {
    half = 0.44F * spacing;
    bottom = 0.5F;
    upper = std::min(2.5F, style.storey - 0.25F);
  }
  if ((storey + 1.0F) * style.storey > top + 0.3F) return look;  // no room for a window below the roof

  const std::uint32_t h = hash_of(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(storey),
                                  material.seed + (front ? 0U : 7U));
  // Lintel and sill around the opening, then its frame, then the panes.
  const auto opening = [&](float grow_x, float grow_up, float grow_down) {
    return pulse(x, -half - grow_x, half + grow_x, wu) *
           pulse(in_storey, bottom - grow_down, upper + grow_up, wv);
  };
  if (!door && !shop && front && style.shutters && storey >= 1.0F) {
    const float reach = std::min(0.45F * style.window_width, 0.5F * spacing - half);
    const float shutter = pulse(std::abs(x), half, half + reach, wu) * pulse(in_storey, bottom, upper, wv);
    const float slats = 0.8F + 0.2F * std::sin(in_storey * 62.8F) * band_weight(0.1F, detail);
    look.albedo = blend(look.albedo, material.accent * 1.3F * slats, shutter);
  }
  look.albedo =
      blend(look.albedo, Colour(0.60F, 0.58F, 0.54F), 0.75F * opening(0.09F, 0.16F, door ? 0.0F : 0.1F));
  const float hole = opening(0.0F, 0.0F, 0.0F);
  if (hole <= 0.0F) return look;
  constexpr float kFrame = 0.07F;
  Colour inside;
  float gloss = 0.0F;
  if (door) {
    const float panel = pulse(std::abs(x), 0.1F, 0.4F, wu) *
                        (pulse(in_storey, 0.35F, 1.0F, wv) + pulse(in_storey, 1.2F, 2.0F, wv));
    inside = material.accent *
             (1.0F - 0.35F * panel + 0.1F * fractal_noise(u, height, detail, {0.3F, 4, 0.8F}, h));
    inside = blend(inside, Colour(0.75F, 0.68F, 0.45F),
                   pulse(x, 0.40F, 0.46F, wu) * pulse(in_storey, 1.02F, 1.12F, wv));
  } else {
    // Glass: dark room, a curtain in some windows, a display in shops.
    const float curtain_share = 0.15F + 0.6F * to_unit(mix_bits(h + 1U));
    const float folds = 0.8F + 0.2F * std::sin(u * 40.0F + to_unit(h) * 6.0F) * band_weight(0.16F, detail);
    const float curtain =
        to_unit(h) < 0.6F ? pulse(std::abs(x), half * (1.0F - curtain_share), half, wu) : 0.0F;
    const float blind = to_unit(mix_bits(h + 2U)) < 0.3F
                            ? pulse(in_storey, mix(bottom, upper, to_unit(mix_bits(h + 3U))), upper, wv)
                            : 0.0F;
    inside = Colour(0.030F, 0.036F, 0.045F) * (0.7F + 0.8F * to_unit(mix_bits(h + 4U)));
    if (shop) {
      const float goods = fractal_noise(u, height, detail, {0.7F, 6, 0.9F}, h);
      inside = Colour(0.16F, 0.12F, 0.09F) * std::max(0.1F, 1.0F + 1.1F * goods);
    }
    inside = blend(inside, Colour(0.55F, 0.53F, 0.48F) * folds, 0.8F * curtain);
    inside = blend(inside, Colour(0.50F, 0.46F, 0.38F), 0.9F * blind);
    // The street mirrored in the panes, wavy as old glass is.
    const float mirrored = fractal_noise(u, height, detail, {1.1F, 4, 0.7F}, h + 9U);
    inside += Colour(0.16F, 0.20F, 0.26F) * smooth_step(0.0F, 0.8F, mirrored + 0.5F * (in_storey - 1.2F));
    gloss = 0.10F;
    const float panes = shop ? 0.0F
                             : pulse(x, -0.03F, 0.03F, wu) + pulse(in_storey, mix(bottom, upper, 0.68F),
                                                                   mix(bottom, upper, 0.68F) + 0.05F, wv);
    const float frame = 1.0F - pulse(x, -half + kFrame, half - kFrame, wu) *
                                   pulse(in_storey, bottom + kFrame, upper - kFrame, wv) *
                                   (1.0F - clamp01(panes));
    const Colour frame_colour = (h & 3U) == 0U ? Colour(0.28F, 0.20F, 0.13F) : Colour(0.72F, 0.72F, 0.70F);
    inside = blend(inside, frame_colour, clamp01(frame));
    // The reveal throws a shadow on the upper edge.
    inside *= 1.0F - 0.5F * pulse(in_storey, upper - 0.16F, upper, wv);
  }
  look.albedo = blend(look.albedo, inside, hole);
  look.gloss = gloss * hole;
  return look;
}

Appearance roof_appearance(const Material& material, const SurfacePoint& point) {
  Appearance look;
  const float u = point.position.z(), v = point.position.x() - point.position.y();
  const float detail = point.detail(1, 2);
  const float row = v / 0.33F, row_number = std::floor(row);
  const float column = u / 0.24F + ((static_cast<int>(row_number) & 1) != 0 ? 0.5F : 0.0F);
  const float tone =
      to_unit(hash_of(static_cast<std::uint32_t>(static_cast<int>(row_number)),
                      static_cast<std::uint32_t>(static_cast<int>(std::floor(column))), material.seed));
  const float visible = band_weight(0.33F, detail);
  const float patina = point.texture * fractal_noise(u, v, detail, {3.0F, 8, 0.95F}, material.seed + 5U);
  const float edge = pulse(row - row_number, 0.0F, 0.2F, detail / 0.33F);
  look.albedo = material.colour * (1.0F + 0.25F * patina + visible * (0.5F * (tone - 0.5F) - 0.4F * edge));
  return look;
}

}  // namespace penumbra::slam::synthetic
