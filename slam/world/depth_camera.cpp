#include "slam/world/depth_camera.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "nn/base/parallel.h"
#include "slam/world/camera_sensor.h"
#include "slam/world/noise.h"

namespace penumbra::slam::synthetic {

namespace {

// Smooth noise over an image that changes with `t`: two images of value noise, faded so that the variance
// stays the same.
float lasting_noise(float x, float y, float t, std::uint32_t seed) {
  const int step = floor_int(t);
  const float weight = t - static_cast<float>(step);
  const auto image = [&](int number) {
    return value_noise(x, y, hash_of(seed, static_cast<std::uint32_t>(number)));
  };
  const float norm = 1.0F / std::sqrt(weight * weight + (1.0F - weight) * (1.0F - weight));
  return norm * mix(image(step), image(step + 1), weight);
}

// The share of places at which lasting_noise is below a value, as a table over [-1, 1].
float share_below(float value) {
  constexpr int kBins = 256;
  static const std::array<float, kBins + 1> table = [] {
    std::array<float, kBins + 1> shares{};
    constexpr int kSamples = 1 << 16;
    RandomSequence random(77U);
    for (int i = 0; i < kSamples; ++i) {
      const float x = random.uniform(0.0F, 500.0F), y = random.uniform(0.0F, 500.0F),
                  z = random.uniform(0.0F, 500.0F);
      const int bin = static_cast<int>((0.5F + 0.5F * lasting_noise(x, y, z, 5U)) * kBins);
      shares[static_cast<std::size_t>(std::clamp(bin, 0, kBins - 1)) + 1] += 1.0F / kSamples;
    }
    for (std::size_t i = 0; i < kBins; ++i) shares[i + 1] += shares[i];
    return shares;
  }();
  const float at = std::clamp((0.5F + 0.5F * value) * kBins, 0.0F, kBins - 0.01F);
  const auto i = static_cast<std::size_t>(at);
  return mix(table[i], table[i + 1], at - static_cast<float>(i));
}

// A number of [least, most] for three rows at a time, so that edges are ragged.
float ragged(float least, float most, int row, int number, std::uint32_t seed) {
  return mix(least, most,
             to_unit(hash_of(static_cast<std::uint32_t>(row / 3), static_cast<std::uint32_t>(number), seed)));
}

// Sum over `side` values around each of `count`, `stride` apart; beyond the ends fewer.
void running_sum(const float* from, float* to, int count, int stride, int side) {
  const int before = side / 2, after = side - 1 - before;
  float sum = 0.0F;
  for (int i = 0; i < std::min(after, count); ++i) sum += from[i * stride];
  for (int i = 0; i < count; ++i) {
    if (i + after < count) sum += from[(i + after) * stride];
    if (i - before - 1 >= 0) sum -= from[(i - before - 1) * stride];
    to[i * stride] = sum;
  }
}

}  // namespace

void DepthCamera::make_noise(const Size& size, int number) {
  noise_.create(size.width, size.height);
  wide_.create(size.width, size.height);
  narrow_.create(size.width, size.height);
  const std::uint32_t seed = hash_of(seed_, static_cast<std::uint32_t>(number), 0xdeb7U);
  const int width = size.width, height = size.height;
  const auto white = [&](int column, int row, std::uint32_t channel) {
    return gaussian_noise(
        mix_bits(static_cast<std::uint32_t>(row * width + column) * 0x9e3779b1U + seed + channel));
  };
  constexpr int kRows = 8;  // a piece
  parallel_pieces(height, kRows, [&](std::int64_t first, std::int64_t end, int) {
    std::vector<float> line(static_cast<std::size_t>(width));
    for (int row = static_cast<int>(first); row < end; ++row) {
      for (int column = 0; column < width; ++column)
        line[static_cast<std::size_t>(column)] = white(column, row, 1U << 20);
      running_sum(line.data(), &wide_.at(0, row), width, 1, settings_.wide);
      for (int column = 0; column < width; ++column)
        line[static_cast<std::size_t>(column)] = white(column, row, 2U << 20);
      running_sum(line.data(), &narrow_.at(0, row), width, 1, settings_.narrow);
    }
  });
  // Down the columns, a block of them at a time.
  const float wide = std::sqrt(settings_.wide_share) / static_cast<float>(settings_.wide),
              narrow = std::sqrt(settings_.narrow_share) / static_cast<float>(settings_.narrow),
              own = std::sqrt(std::max(0.0F, 1.0F - settings_.wide_share - settings_.narrow_share));
  constexpr int kBlock = 32;
  parallel_pieces(width, kBlock, [&](std::int64_t first, std::int64_t end, int) {
    const int left = static_cast<int>(first), count = static_cast<int>(end - first);
    std::array<float, kBlock> wide_sum{}, narrow_sum{};
    const auto slide = [&](const FloatImage& means, int side, int row, std::array<float, kBlock>& sum) {
      const int before = side / 2, after = side - 1 - before;
      for (int i = 0; i < count; ++i) {
        float& s = sum[static_cast<std::size_t>(i)];
        if (row == 0) {
          s = 0.0F;
          for (int r = 0; r <= std::min(after, height - 1); ++r) s += means.at(left + i, r);
          continue;
        }
        if (row + after < height) s += means.at(left + i, row + after);
        if (row - before - 1 >= 0) s -= means.at(left + i, row - before - 1);
      }
    };
    for (int row = 0; row < height; ++row) {
      slide(wide_, settings_.wide, row, wide_sum);
      slide(narrow_, settings_.narrow, row, narrow_sum);
      for (int i = 0; i < count; ++i) {
        noise_.at(left + i, row) = wide * wide_sum[static_cast<std::size_t>(i)] +
                                   narrow * narrow_sum[static_cast<std::size_t>(i)] +
                                   own * white(left + i, row, 3U << 20);
      }
    }
  });
}

void DepthCamera::displace_edges(const FloatImage& truth, int number) {
  seen_.create(truth.width(), truth.height());
  const float fb = settings_.focal_baseline, reach = settings_.wobble;
  const int width = truth.width(), height = truth.height();
  parallel_for(height, 8, [&](int row) {
    const int above = std::max(0, row - 2), below = std::min(height - 1, row + 2);
    for (int column = 0; column < width; ++column) {
      float& seen = seen_.at(column, row) = truth.at(column, row);
      if (reach <= 0.0F) continue;
      const int left = std::max(0, column - 2), right = std::min(width - 1, column + 2);
      const auto inverse = [&](int u, int v) { return fb / std::max(0.1F, truth.at(u, v)); };
      if (std::abs(inverse(left, row) - inverse(right, row)) < settings_.jump &&
          std::abs(inverse(column, above) - inverse(column, below)) < settings_.jump) {
        continue;
      }
      const float x = 0.28F * static_cast<float>(column), y = 0.28F * static_cast<float>(row),
                  t = 0.4F * static_cast<float>(number);
      const int du = static_cast<int>(std::lround(reach * value_noise(x, y, t, seed_ + 11U)));
      const int dv = static_cast<int>(std::lround(reach * value_noise(x, y, t, seed_ + 12U)));
      seen = truth.at(std::clamp(column + du, 0, width - 1), std::clamp(row + dv, 0, height - 1));
    }
  });
}

// Makes holes of what the projector or second imager, to the right of the camera, cannot see; see
// depth_sensor.cpp. From right to left the places in its image fall; where they do not, something nearer
// hides the point.
void DepthCamera::cast_shadows(const FloatImage& seen, int row, int number, FloatImage& depth) const {
  const int width = seen.width();
  const float scale = static_cast<float>(width) / 640.0F;
  if (settings_.shadow_slope > 0.0F) {
    const float trim =
        ragged(settings_.shadow_trim_least, settings_.shadow_trim_most, row, number, seed_ + 1U);
    const int extra = static_cast<int>(ragged(static_cast<float>(settings_.shadow_extra_least),
                                              static_cast<float>(settings_.shadow_extra_most) + 0.99F, row,
                                              number, seed_ + 2U));
    float leftmost = 1e9F;
    int hidden = 0, more = 0;
    for (int column = width - 1; column >= 0; --column) {
      const float z = seen.at(column, row);
      const float place = static_cast<float>(column) - scale * settings_.shadow_slope / std::max(z, 0.1F);
      if (place >= leftmost + trim) {
        depth.at(column, row) = 0.0F;
        if (++hidden >= 2) more = extra;
        continue;
      }
      hidden = 0;
      if (more-- > 0) depth.at(column, row) = 0.0F;
      leftmost = std::min(leftmost, place);
    }
  }
  if (settings_.gap_most <= 0) return;
  const float fb = settings_.focal_baseline;
  const int gap =
      static_cast<int>(ragged(static_cast<float>(settings_.gap_least),
                              static_cast<float>(settings_.gap_most) + 0.99F, row, number, seed_ + 3U));
  for (int column = 1; column < width; ++column) {
    const float near = seen.at(column - 1, row), far = seen.at(column, row);
    if (fb / std::max(near, 0.1F) - fb / std::max(far, 0.1F) < settings_.jump) continue;
    for (int i = column; i < std::min(width, column + gap); ++i) {
      if (seen.at(i, row) > near) depth.at(i, row) = 0.0F;
    }
  }
}

bool DepthCamera::is_lost(float z, float grey, int column, int row, int number, bool& saturated) const {
  const float scale = 1.0F / settings_.patch_size;
  // Turned and bent, so that patches show no grid.
  const float u = scale * (0.87F * static_cast<float>(column) + 0.5F * static_cast<float>(row)),
              v = scale * (0.87F * static_cast<float>(row) - 0.5F * static_cast<float>(column));
  const float bend = 0.45F * value_noise(1.9F * u, 1.9F * v, seed_ + 19U);
  const float x = u + bend, y = v - bend, t = settings_.patch_rate * static_cast<float>(number);
  const auto patch = [&](std::uint32_t channel) {
    return share_below(lasting_noise(x, y, t, seed_ + channel));
  };
  const float dark =
      settings_.dark_share * (1.0F - smooth_step(settings_.dark_level, 1.75F * settings_.dark_level, grey));
  const float glare = settings_.glare_share * smooth_step(222.0F, 235.0F, grey);
  const float far = smooth_step(settings_.fade_from, settings_.farthest, z);
  const float lost = 1.0F - (1.0F - dark) * (1.0F - glare) * (1.0F - far) * (1.0F - settings_.scatter_share);
  if (settings_.saturated_share > 0.0F && (z > 3.0F || grey > 250.0F)) {
    // Rarer and larger blobs than those of other holes.
    const float blob = share_below(lasting_noise(0.3F * x, 0.3F * y, 0.1F * t, seed_ + 21U));
    if (blob < settings_.saturated_share) {
      saturated = true;
      return false;
    }
  }
  return lost > 0.0F && patch(20U) < lost;
}

void DepthCamera::sense(const FloatImage& truth, const ByteImage& bgr, int number, FloatImage& depth) {
  const Size size = truth.size();
  depth.create(size.width, size.height);
  make_noise(size, number);
  displace_edges(truth, number);
  const float scale_x = static_cast<float>(size.width) / 640.0F,
              scale_y = static_cast<float>(size.height) / 480.0F;
  const auto scaled = [](int pixels, float scale) {
    return static_cast<int>(std::lround(static_cast<float>(pixels) * scale));
  };
  const int left = scaled(settings_.band_left, scale_x),
            right = size.width - scaled(settings_.band_right, scale_x),
            top = scaled(settings_.band_top, scale_y),
            bottom = size.height - scaled(settings_.band_bottom, scale_y);
  const float fb = settings_.focal_baseline;
  parallel_for(size.height, 8, [&](int row) {
    float* sensed = &depth.at(0, row);
    const float* z = &seen_.at(0, row);
    for (int column = 0; column < size.width; ++column) {
      const bool outside = row < top || row >= bottom || column < left || column >= right;
      sensed[column] =
          outside || z[column] < settings_.nearest || z[column] > settings_.farthest ? 0.0F : z[column];
    }
    cast_shadows(seen_, row, number, depth);
    for (int column = 0; column < size.width; ++column) {
      if (sensed[column] <= 0.0F) continue;
      const std::uint8_t* pixel = &bgr.at(column, row);
      const float grey = 0.114F * pixel[0] + 0.587F * pixel[1] + 0.299F * pixel[2];
      bool saturated = false;
      if (is_lost(z[column], grey, column, row, number, saturated)) {
        sensed[column] = 0.0F;
        continue;
      }
      if (saturated) {
        sensed[column] = kSaturatedDepth;
        continue;
      }
      const float share = clamp01(0.5F * (z[column] - 1.0F));
      float d =
          fb / z[column] + mix(settings_.noise_near, settings_.noise_far, share) * noise_.at(column, row);
      if (settings_.flying_share > 0.0F && column >= 3 && column + 3 < size.width) {
        const float other = fb / std::max(0.1F, z[column - 3]), another = fb / std::max(0.1F, z[column + 3]);
        const std::uint32_t h = hash_of(static_cast<std::uint32_t>(row * size.width + column),
                                        static_cast<std::uint32_t>(number), seed_ + 9U);
        if (std::abs(other - another) > settings_.jump && to_unit(h) < settings_.flying_share)
          d = mix(other, another, 0.25F + 0.5F * to_unit(mix_bits(h)));
      }
      if (settings_.disparity_step > 0.0F)
        d = std::round(d / settings_.disparity_step) * settings_.disparity_step;
      float measured = d > 0.0F ? fb / d : 0.0F;
      if (settings_.depth_step > 0.0F)
        measured = std::round(measured / settings_.depth_step) * settings_.depth_step;
      sensed[column] = measured;
    }
  });
}

WordImage encode_sensed_depth(const FloatImage& depth, float levels_a_metre) {
  WordImage encoded(depth.width(), depth.height());
  for (int row = 0; row < depth.height(); ++row) {
    for (int column = 0; column < depth.width(); ++column) {
      const float z = depth.at(column, row);
      const float level = std::round(levels_a_metre * z);
      encoded.at(column, row) = z == kSaturatedDepth               ? std::uint16_t{65535}
                                : level > 0.0F && level < 65534.5F ? static_cast<std::uint16_t>(level)
                                                                   : std::uint16_t{0};
    }
  }
  return encoded;
}

}  // namespace penumbra::slam::synthetic
