#include "slam/frontend/features/descriptor_matcher.h"

#include "slam/frontend/features/nearest_descriptor.h"

namespace penumbra::slam {

std::vector<Match> match_descriptors(std::span<const Descriptor> a, std::span<const Descriptor> b,
                                     const DescriptorMatcherSettings& settings) {
  std::vector<NearestDescriptor> of_a(a.size()), of_b(b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      const int d = hamming_distance(a[i], b[j]);
      of_a[i].offer(static_cast<int>(j), d);
      of_b[j].offer(static_cast<int>(i), d);
    }
  }
  std::vector<Match> matches;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const NearestDescriptor& n = of_a[i];
    if (n.index < 0 || n.distance > settings.max_distance) continue;
    if (of_b[static_cast<std::size_t>(n.index)].index != static_cast<int>(i)) continue;
    if (n.is_ambiguous(settings.ratio)) continue;
    matches.push_back({static_cast<int>(i), n.index, n.distance});
  }
  return matches;
}

}  // namespace penumbra::slam
