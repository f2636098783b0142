#include "slam/frontend/features/descriptor_matcher.h"

#include <algorithm>
#include <limits>

#include "nn/simd/kernel_table.h"
#include "slam/frontend/features/nearest_descriptor.h"

namespace penumbra::slam {

namespace {

static_assert(sizeof(Descriptor) == nn::kBitRowWords * sizeof(std::uint64_t));

// The nearest of b's descriptors, and the second: most of a row is no nearer and is passed over by the dozen.
NearestDescriptor nearest_in(std::span<const std::uint16_t> distances) {
  constexpr std::size_t kGroup = 32;
  NearestDescriptor nearest;
  for (std::size_t begin = 0; begin < distances.size(); begin += kGroup) {
    const std::size_t end = std::min(begin + kGroup, distances.size());
    std::uint16_t least = std::numeric_limits<std::uint16_t>::max();
    for (std::size_t j = begin; j < end; ++j) least = std::min(least, distances[j]);
    if (least >= nearest.second_distance) continue;
    for (std::size_t j = begin; j < end; ++j) nearest.offer(static_cast<int>(j), distances[j]);
  }
  return nearest;
}

}  // namespace

std::vector<Match> match_descriptors(std::span<const Descriptor> a, std::span<const Descriptor> b,
                                     const DescriptorMatcherSettings& settings) {
  const auto compare = nn::kernels().bit_differences;
  std::vector<std::uint16_t> distances(b.size());
  std::vector<NearestDescriptor> of_a;
  of_a.reserve(a.size());
  // Of each of b's: how near the nearest of a's is, and which.
  std::vector<std::uint16_t> least(b.size(), kDescriptorBits + 1);
  std::vector<std::uint32_t> of_b(b.size(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    compare(a[i].data(), b.empty() ? nullptr : b.front().data(), static_cast<int>(b.size()),
            distances.data());
    of_a.push_back(nearest_in(distances));
    for (std::size_t j = 0; j < b.size(); ++j) {
      of_b[j] = distances[j] < least[j] ? static_cast<std::uint32_t>(i) : of_b[j];
      least[j] = std::min(least[j], distances[j]);
    }
  }
  std::vector<Match> matches;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const NearestDescriptor& n = of_a[i];
    if (n.index < 0 || n.distance > settings.max_distance) continue;
    if (of_b[static_cast<std::size_t>(n.index)] != static_cast<std::uint32_t>(i)) continue;
    if (n.is_ambiguous(settings.ratio)) continue;
    matches.push_back({static_cast<int>(i), n.index, n.distance});
  }
  return matches;
}

}  // namespace penumbra::slam
