#include "slam/frontend/features/descriptor_matcher.h"

#include "slam/frontend/features/nearest_descriptor.h"
#include "tests/support/image_cases.h"

namespace penumbra::slam {
namespace {

class DescriptorMatcher : public test::EveryIsa {};

// The definition, pair by pair.
std::vector<Match> naive_matches(const std::vector<Descriptor>& a, const std::vector<Descriptor>& b,
                                 const DescriptorMatcherSettings& settings) {
  std::vector<NearestDescriptor> of_a(a.size()), of_b(b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      of_a[i].offer(static_cast<int>(j), hamming_distance(a[i], b[j]));
      of_b[j].offer(static_cast<int>(i), hamming_distance(a[i], b[j]));
    }
  }
  std::vector<Match> matches;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const NearestDescriptor& n = of_a[i];
    if (n.index < 0 || n.distance > settings.max_distance || n.is_ambiguous(settings.ratio)) continue;
    if (of_b[static_cast<std::size_t>(n.index)].index == static_cast<int>(i))
      matches.push_back({static_cast<int>(i), n.index, n.distance});
  }
  return matches;
}

TEST_P(DescriptorMatcher, FindsThePairsOfTheDefinition) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    std::vector<Descriptor> a(counter_random(seed, 0) % 90), b(counter_random(seed, 1) % 90);
    for (std::size_t j = 0; j < b.size(); ++j) {
      for (std::size_t w = 0; w < 4; ++w) b[j][w] = counter_random(seed + 100, 4 * j + w);
      if (j % 7 == 3) b[j] = b[j - 1];  // equals: the first counts
    }
    for (std::size_t i = 0; i < a.size(); ++i) {
      // Those of b with some bits flipped, some of them twice.
      a[i] = b.empty() ? Descriptor{} : b[counter_random(seed + 200, i) % b.size()];
      for (std::uint64_t n = 0; n < counter_random(seed + 300, i) % 80; ++n) {
        const std::uint64_t bit = counter_random(seed + 400 + i, n) % 256;
        a[i][bit / 64] ^= std::uint64_t{1} << (bit % 64);
      }
    }
    for (const DescriptorMatcherSettings settings : {DescriptorMatcherSettings{}, {256, 1.0F}, {20, 0.5F}}) {
      const std::vector<Match> ours = match_descriptors(a, b, settings),
                               naive = naive_matches(a, b, settings);
      ASSERT_EQ(ours.size(), naive.size()) << seed;
      for (std::size_t m = 0; m < ours.size(); ++m) {
        EXPECT_EQ(ours[m].source, naive[m].source);
        EXPECT_EQ(ours[m].feature, naive[m].feature);
        EXPECT_EQ(ours[m].distance, naive[m].distance);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Isa, DescriptorMatcher, test::every_isa(), test::isa_name);

}  // namespace
}  // namespace penumbra::slam
