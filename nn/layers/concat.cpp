#include "nn/layers/concat.h"

#include <algorithm>
#include <cstring>

#include "nn/base/error.h"
#include "nn/base/parallel.h"

namespace penumbra::nn {

namespace {

// to[to_first ..] = from[from_first ..], `count` channels of all pixels of image n. Moves as many lanes at a
// time as lie side by side in both maps.
void copy_channels(const FeatureMap& from, int from_first, FeatureMap& to, int to_first, int count, int n) {
  for (int c = 0; c < count;) {
    const int from_lane = (from_first + c) % kBlock, to_lane = (to_first + c) % kBlock;
    const int lanes = std::min({kBlock - from_lane, kBlock - to_lane, count - c});
    const int from_block = (from_first + c) / kBlock, to_block = (to_first + c) / kBlock;
    for (int y = 0; y < from.height(); ++y) {
      const float* in = from.pixel(n, from_block, y, 0) + from_lane;
      float* out = to.pixel(n, to_block, y, 0) + to_lane;
      if (lanes == kBlock) {
        std::memcpy(out, in, static_cast<std::size_t>(from.width()) * kBlock * sizeof(float));
        continue;
      }
      for (int x = 0; x < from.width(); ++x) {
        for (int l = 0; l < lanes; ++l) out[x * kBlock + l] = in[x * kBlock + l];
      }
    }
    c += lanes;
  }
}

// The lanes of the last block that no channel uses: a layer that reads whole blocks must find numbers there.
void clear_unused_lanes(FeatureMap& map, int n) {
  const int used = map.channels() - (map.blocks() - 1) * kBlock;
  if (used == kBlock) return;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) {
      float* f = map.pixel(n, map.blocks() - 1, y, x);
      std::fill(f + used, f + kBlock, 0.0F);
    }
  }
}

}  // namespace

FeatureMap concat(std::span<const FeatureMap* const> maps, Arena& arena, int output_border) {
  if (maps.empty()) throw InputError("concat", "at least one map", "none");
  const FeatureMap& first = *maps.front();
  int channels = 0;
  for (const FeatureMap* map : maps) {
    if (map->images() != first.images() || map->height() != first.height() || map->width() != first.width() ||
        map->block() != kBlock) {
      throw InputError("concat",
                       fmt::format("{} images of {} x {} in blocks of {}", first.images(), first.height(),
                                   first.width(), kBlock),
                       fmt::format("{} of {} x {} in blocks of {}", map->images(), map->height(),
                                   map->width(), map->block()));
    }
    channels += map->channels();
  }
  FeatureMap output(arena, first.batch(), channels, first.height(), first.width(), output_border);
  parallel_for(output.images(), grain_of(output.image_stride()), [&](int n) {
    int start = 0;
    for (const FeatureMap* map : maps) {
      copy_channels(*map, 0, output, start, map->channels(), n);
      start += map->channels();
    }
    clear_unused_lanes(output, n);
  });
  return output;
}

FeatureMap slice_channels(const FeatureMap& map, int first, int count, Arena& arena, int output_border) {
  if (first < 0 || count < 1 || count > map.channels() - first || map.block() != kBlock) {
    throw InputError("slice_channels", fmt::format("channels of a map of {}", map.channels()),
                     fmt::format("{} from {} on", count, first));
  }
  FeatureMap output(arena, map.batch(), count, map.height(), map.width(), output_border);
  parallel_for(output.images(), grain_of(output.image_stride()), [&](int n) {
    copy_channels(map, first, output, 0, count, n);
    clear_unused_lanes(output, n);
  });
  return output;
}

std::vector<FeatureMap> split(const FeatureMap& map, std::span<const int> channels, Arena& arena,
                              int output_border) {
  std::vector<FeatureMap> parts;
  int first = 0;
  for (const int count : channels) {
    parts.push_back(slice_channels(map, first, count, arena, output_border));
    first += count;
  }
  if (first != map.channels()) {
    throw InputError("split", fmt::format("parts of {} channels in all", map.channels()),
                     fmt::format("{}", first));
  }
  return parts;
}

}  // namespace penumbra::nn
