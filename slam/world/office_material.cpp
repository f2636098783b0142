// What an office's surfaces look like: paint, carpet, wood, print, screens, clothes.
#include <cmath>

#include "slam/world/materials.h"

namespace penumbra::slam::synthetic {

namespace {

// A place on a face of a box-like body, in metres from the corner of least coordinates.
struct FacePlace {
  int a = 0, b = 1;  // axes of the object's frame
  float u = 0.0F, v = 0.0F, width = 1.0F, height = 1.0F;
  float wu = 0.0F, wv = 0.0F;  // a pixel's extent
  float detail = 0.0F;
};

FacePlace place_on(const Body& body, const SurfacePoint& point) {
  FacePlace at;
  drawing_axes(point.normal, at.a, at.b);
  at.u = point.position[at.a] - body.lower[at.a];
  at.v = point.position[at.b] - body.lower[at.b];
  at.width = body.upper[at.a] - body.lower[at.a];
  at.height = body.upper[at.b] - body.lower[at.b];
  at.detail = point.detail(at.a, at.b);
  at.wu = std::max(point.footprint[at.a], 0.3F * point.footprint[at.b]);
  at.wv = std::max(point.footprint[at.b], 0.3F * point.footprint[at.a]);
  return at;
}

std::uint32_t cell_hash(float x, float y, std::uint32_t seed) {
  return hash_of(static_cast<std::uint32_t>(floor_int(x) + 4096),
                 static_cast<std::uint32_t>(floor_int(y) + 4096), seed);
}

// How much ink lies at (u, v) of a block of text with lines `line` metres apart: words of random lengths.
float text_ink(float u, float v, float line, float wu, float wv, std::uint32_t seed) {
  const float visible = band_weight(line, std::max(wv, 0.5F * wu));
  if (visible <= 0.0F) return 0.35F * 0.5F;  // grey where letters cannot be told apart
  const float row = v / line, in_row = row - std::floor(row);
  const float letter = u / (0.55F * line);
  const std::uint32_t word = cell_hash(letter / 5.0F, row, seed),
                      stroke = cell_hash(letter * 2.0F, row, seed + 3U);
  if (word % 6U == 0U) return 0.0F;
  const float bar = pulse(in_row, 0.2F, 0.75F, wv / line);
  const float strokes = (stroke & 1U) != 0U ? 1.0F : 0.25F;
  return bar * mix(0.5F, strokes, visible);
}

Colour hashed_colour(std::uint32_t h) {
  return Colour(0.06F + 0.6F * to_unit(h), 0.06F + 0.6F * to_unit(mix_bits(h + 1U)),
                0.06F + 0.6F * to_unit(mix_bits(h + 2U)));
}

// A printed sheet: a head line, then a grid of blocks that are text, pictures or charts.
Colour print_at(const Material& material, const FacePlace& at) {
  const float margin = 0.06F * std::min(at.width, at.height);
  const float u = at.u - margin, v = at.v - margin, width = at.width - 2.0F * margin,
              height = at.height - 2.0F * margin;
  Colour colour = material.colour;
  if (u < 0.0F || v < 0.0F || u > width || v > height) return colour;
  const float head = 0.13F * height;
  if (v < head) {
    const float ink = text_ink(u, v, 0.8F * head, at.wu, at.wv, material.seed + 1U);
    return blend(colour, material.accent, ink);
  }
  const int columns = 2 + static_cast<int>(material.seed % 3U),
            rows = 3 + static_cast<int>((material.seed >> 4) % 3U);
  const float cu = width / static_cast<float>(columns), cv = (height - head) / static_cast<float>(rows);
  const float x = u / cu, y = (v - head) / cv;
  const std::uint32_t h = cell_hash(x, y, material.seed + 2U);
  const float bu = (x - std::floor(x)) * cu, bv = (y - std::floor(y)) * cv;
  const float inside = pulse(bu, 0.05F * cu, 0.95F * cu, at.wu) * pulse(bv, 0.05F * cv, 0.93F * cv, at.wv);
  Colour block = colour;
  if (h % 5U < 2U) {
    const float line = std::max(0.012F, 0.11F * cv);
    block = blend(colour, Colour::Constant(0.05F), 0.8F * text_ink(bu, bv, line, at.wu, at.wv, h));
  } else if (h % 5U < 4U) {
    // A picture: shapes of three colours.
    const float shape = fractal_noise(at.u, at.v, at.detail, {0.25F * cu, 5, 0.7F}, h);
    block = blend(hashed_colour(h), hashed_colour(h + 9U), smooth_step(-0.1F, 0.1F, shape));
    block = blend(block, hashed_colour(h + 17U), smooth_step(0.35F, 0.45F, shape));
  } else {
    const float bar = std::floor(8.0F * bu / cu);
    const float tall = cv * (0.2F + 0.7F * to_unit(cell_hash(bar, 0.0F, h)));
    block = blend(colour, material.accent, pulse(bv, cv - tall, cv, at.wv));
  }
  return blend(colour, block, inside);
}

Colour garment_at(const Material& material, const SurfacePoint& point) {
  const Eigen::Vector3f& p = point.position;
  const float detail =
      std::max({0.5F * point.footprint.x(), 0.5F * point.footprint.y(), 0.5F * point.footprint.z()});
  const float folds = fractal_noise(p.x(), 0.5F * p.y(), p.z(), detail, {0.16F, 5, 0.85F}, material.seed);
  Colour colour = material.colour;
  const float pitch = 0.03F + 0.03F * to_unit(mix_bits(material.seed));
  const float soft = std::max(detail, 0.002F);
  const auto stripe = [&](float x) {
    const float t = x / pitch - std::floor(x / pitch);
    return mix(0.4F, pulse(t, 0.3F, 0.7F, soft / pitch), band_weight(pitch, detail));
  };
  switch (material.seed % 5U) {
    case 0:  // checks
      colour = blend(colour, material.accent, 0.5F * (stripe(p.y()) + stripe(p.x() + 0.4F * p.z())));
      break;
    case 1:  // stripes
      colour = blend(colour, material.accent, 0.85F * stripe(p.y()));
      break;
    case 2: {  // a print
      const float print = fractal_noise(p.x(), p.y(), p.z(), detail, {0.07F, 3, 0.6F}, material.seed + 7U);
      colour = blend(colour, material.accent, smooth_step(0.05F, 0.15F, print));
      break;
    }
    default:;
  }
  return colour * std::max(0.25F, 1.0F + 0.35F * point.texture * folds);
}

}  // namespace

Appearance office_appearance(const Material& material, const Body& body, int face,
                             const SurfacePoint& point) {
  const FacePlace at = place_on(body, point);
  const Eigen::Vector3f& p = point.position;
  const float texture = point.texture;
  Appearance look;
  look.albedo = material.colour;
  switch (material.surface) {
    case Surface::painted_wall: {
      const float stain =
          texture * fractal_noise(p[at.a], p[at.b], at.detail, {0.9F, 6, 0.6F}, material.seed);
      look.albedo *= 1.0F + 0.03F * stain;
      if (at.b == 1)  // skirting
        look.albedo = blend(look.albedo, Colour::Constant(0.16F), pulse(p.y(), -0.09F, 0.0F, at.wv));
      break;
    }
    case Surface::ceiling: {
      const float x = p.x() / 0.6F, z = p.z() / 0.6F;
      const float joint = pulse(x - std::floor(x), 0.0F, 0.03F, at.wu / 0.6F) +
                          pulse(z - std::floor(z), 0.0F, 0.03F, at.wv / 0.6F);
      const float holes = spots(p.x(), p.z(), 0.03F, at.detail, material.seed);
      look.albedo *= (1.0F - 0.4F * std::min(1.0F, joint) * band_weight(0.3F, at.detail)) *
                     (1.0F - 0.3F * texture * std::abs(holes));
      break;
    }
    case Surface::carpet: {
      const float tile = to_unit(cell_hash(p.x() / 0.5F, p.z() / 0.5F, material.seed));
      const float pile = texture * fractal_noise(p.x(), p.z(), at.detail, {0.12F, 6, 0.95F}, material.seed);
      const float stains =
          texture * fractal_noise(p.x(), p.z(), at.detail, {1.5F, 3, 0.7F}, material.seed + 5U);
      look.albedo *= std::max(0.3F, 0.94F + 0.12F * tile + 0.16F * pile + 0.10F * stains);
      break;
    }
    case Surface::wood: {
      const bool along_u = at.width > at.height;
      const float along = along_u ? at.u : at.v, across = along_u ? at.v : at.u;
      const float grain =
          texture * fractal_noise(0.08F * along, across, at.detail, {0.05F, 4, 0.8F}, material.seed);
      look.albedo *= std::max(0.4F, 1.0F + 0.14F * grain);
      look.gloss = 0.03F;
      break;
    }
    case Surface::poster:
      look.albedo = print_at(material, at);
      break;
    case Surface::screen: {
      look.gloss = 0.06F;
      if (face != 4) break;
      const float border = 0.018F;
      const float inside =
          pulse(at.u, border, at.width - border, at.wu) * pulse(at.v, border, at.height - border, at.wv);
      look.gloss = mix(0.02F, 0.10F, inside);
      if (material.accent.isZero() || inside <= 0.0F) break;
      // Windows with text on a desktop.
      Colour shown = material.accent * 0.35F;
      const std::uint32_t h = cell_hash(at.u / 0.21F, at.v / 0.16F, material.seed);
      if (h % 3U != 0U) {
        const Colour page = h % 2U == 0U ? Colour(0.75F, 0.76F, 0.78F) : Colour(0.04F, 0.05F, 0.07F);
        const Colour ink =
            h % 2U == 0U ? Colour(0.08F, 0.08F, 0.12F) : hashed_colour(h) + Colour::Constant(0.2F);
        shown = blend(page, ink, text_ink(at.u, at.v, 0.011F, at.wu, at.wv, h));
      }
      look.glow = shown * (0.7F * inside);
      break;
    }
    case Surface::keys: {
      const float x = at.u / 0.019F, y = at.v / 0.0235F;
      const float key = pulse(x - std::floor(x), 0.1F, 0.9F, at.wu / 0.019F) *
                        pulse(y - std::floor(y), 0.1F, 0.9F, at.wv / 0.0235F);
      look.albedo *= mix(1.4F, 0.5F + 1.8F * key, band_weight(0.04F, at.detail));
      break;
    }
    case Surface::spines: {
      if (face == 15 || at.b != 1) {  // cups, bottles, tops of books
        const float ring = fractal_noise(p.x() + p.z(), p.y(), at.detail, {0.05F, 3, 0.7F}, material.seed);
        look.albedo = blend(material.colour, material.accent, smooth_step(0.0F, 0.1F, ring));
        break;
      }
      // Spines of 2 to 5 cm: the nearest of a jittered row of gaps decides which book this is.
      constexpr float kSpine = 0.034F;
      const float x = at.u / kSpine;
      const float cell = std::floor(x);
      const auto gap = [&](float number) {
        return number + 0.35F * to_unit(cell_hash(number, 0.0F, material.seed));
      };
      const float book = x < gap(cell) ? cell - 1.0F : cell;
      const std::uint32_t h = cell_hash(book, 1.0F, material.seed);
      const float from_gap = std::min(std::abs(x - gap(cell)), std::abs(gap(cell + 1.0F) - x)) * kSpine;
      const Colour cover = h % 4U == 0U ? material.colour : h % 4U == 1U ? material.accent : hashed_colour(h);
      const float title =
          pulse(at.v / at.height, 0.15F, 0.15F + 0.5F * to_unit(mix_bits(h)), at.wv / at.height);
      const float letters = text_ink(at.v, at.u - gap(book) * kSpine, 0.02F, at.wv, at.wu, h);
      look.albedo = blend(cover, to_unit(h) < 0.5F ? Colour::Constant(0.7F) : Colour::Constant(0.04F),
                          0.8F * title * letters);
      look.albedo *= 1.0F - 0.6F * (1.0F - smooth_step(0.0F, 0.004F + 0.5F * at.wu, from_gap)) *
                                band_weight(2.0F * kSpine, at.wu);
      look.gloss = 0.01F;
      break;
    }
    case Surface::window: {
      const float post = pulse(at.u, 0.05F, at.width - 0.05F, at.wu) *
                         pulse(at.v, 0.05F, at.height - 0.05F, at.wv) *
                         (1.0F - pulse(at.u, 0.5F * at.width - 0.025F, 0.5F * at.width + 0.025F, at.wu));
      // Trees before a bright sky.
      const float trees = fractal_noise(at.u, at.v, at.detail, {0.6F, 5, 0.8F}, material.seed);
      const float low = smooth_step(0.35F, 0.75F, at.v / at.height + 0.15F * trees);
      const Colour outside =
          blend(Colour(1.7F, 1.8F, 1.9F), Colour(0.55F, 0.62F, 0.45F) * (1.0F + 0.4F * trees), low);
      look.albedo = Colour::Constant(mix(0.7F, 0.03F, post));
      look.glow = outside * post;
      look.gloss = 0.3F * post;
      break;
    }
    case Surface::lamp:
      look.glow = Colour(2.2F, 2.15F, 2.0F);
      break;
    case Surface::garment:
      look.albedo = garment_at(material, point);
      break;
    case Surface::plastic: {
      const float dirt = fractal_noise(p[at.a], p[at.b], at.detail, {0.3F, 5, 0.6F}, material.seed);
      look.albedo *= 1.0F + 0.04F * texture * dirt;
      look.gloss = 0.04F;
      break;
    }
    case Surface::skin: {
      const float tone = fractal_noise(p.x(), p.y(), p.z(), at.detail, {0.04F, 3, 0.7F}, material.seed);
      look.albedo *= 1.0F + 0.08F * texture * tone;
      look.gloss = 0.015F;
      break;
    }
    default:
      return plain_appearance(material, point);
  }
  return look;
}

}  // namespace penumbra::slam::synthetic
