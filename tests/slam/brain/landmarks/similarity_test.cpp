#include "slam/brain/landmarks/similarity.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "nn/base/counter_random.h"
#include "nn/base/stopwatch.h"
#include "slam/brain/landmarks/landmark_index.h"

namespace penumbra::slam::brain {
namespace {

// Unit length, with cosine `c` to the direction of axis `axis`; the rest along `other`.
Descriptor along(int axis, double c = 1.0, int other = 31) {
  Descriptor d{};
  d[static_cast<std::size_t>(axis)] = static_cast<float>(c);
  d[static_cast<std::size_t>(other)] += static_cast<float>(std::sqrt(1.0 - c * c));
  return d;
}

Landmark landmark(int landmark_class, const Descriptor& descriptor, float interest) {
  Landmark made;
  made.landmark_class = landmark_class;
  made.interest = interest;
  made.score = 1.0F;
  made.descriptor = descriptor;
  return made;
}

Descriptor random_descriptor(std::uint64_t seed) {
  Descriptor d;
  double squares = 0.0;
  for (std::size_t i = 0; i < d.size(); ++i) {
    d[i] = static_cast<float>(counter_uniform(seed, i) - 0.5);
    squares += static_cast<double>(d[i]) * static_cast<double>(d[i]);
  }
  for (float& value : d) value /= static_cast<float>(std::sqrt(squares));
  return d;
}

Landmarks scene(std::uint64_t seed, int count = kMostLandmarks) {
  Landmarks made;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::uint64_t>(i);
    made.push_back(landmark(kFirstStandingClass + i % kStandingClasses, random_descriptor(1000 * seed + k),
                            static_cast<float>(counter_uniform(seed, k))));
  }
  return made;
}

// The example of docs/brain/interest.md: a rare sign that matches, one of two lamps that does by half.
TEST(Similarity, IsTheExampleOfTheDocs) {
  const Landmarks a{landmark(kSign, along(0), 0.9F), landmark(kLamp, along(1), 0.4F)};
  const Landmarks b{landmark(kSign, along(0), 0.9F), landmark(kLamp, along(1, 0.8), 0.4F),
                    landmark(kLamp, along(2), 0.4F)};
  // l = 1 and (0.8 - 0.6) / 0.4 = 0.5; S = (0.9 * 1 + 0.4 * 0.5) / (0.5 * (1.3 + 1.7)) = 1.1 / 1.5.
  EXPECT_NEAR(similarity(a, b), 1.1 / 1.5, 1e-6);
  // Without interest the lone lamp weighs as much as the sign: 1.5 / 2.5.
  EXPECT_NEAR(similarity(a, b, {.interest = false}), 1.5 / 2.5, 1e-6);
}

TEST(Similarity, IsOneToItselfAndSymmetric) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Landmarks a = scene(seed), b = scene(seed + 100, 17);
    EXPECT_NEAR(similarity(a, a), 1.0, 1e-5);
    EXPECT_DOUBLE_EQ(similarity(a, b), similarity(b, a));
    EXPECT_GE(similarity(a, b), 0.0);
    EXPECT_LT(similarity(a, b), 0.8);
  }
}

TEST(Similarity, IsZeroWithoutLandmarksOrCommonClasses) {
  EXPECT_EQ(similarity({}, {}), 0.0);
  EXPECT_EQ(similarity(scene(1), {}), 0.0);
  EXPECT_EQ(similarity({landmark(kSign, along(0), 1.0F)}, {landmark(kLamp, along(0), 1.0F)}), 0.0);
}

// Three equal windows of one image are not all found again in the one of the other.
TEST(Similarity, PairsOneToOne) {
  const Landmarks a(3, landmark(kFacade, along(0), 0.5F)), b(1, landmark(kFacade, along(0), 0.5F));
  EXPECT_NEAR(similarity(a, b), 0.5 / (0.5 * 2.0), 1e-6);
}

TEST(Similarity, LandmarksBeyondTheMostDoNotCount) {
  Landmarks a = scene(3);
  const double before = similarity(a, scene(4));
  a.push_back(scene(4).front());
  EXPECT_EQ(similarity(a, scene(4)), before);
}

TEST(LandmarkIndex, FindsTheTemplateOfAPlaceAmongManyInTime) {
  LandmarkIndex index;
  constexpr int kTemplates = 2000;
  for (int i = 0; i < kTemplates; ++i) EXPECT_EQ(index.add(scene(static_cast<std::uint64_t>(i))), i);
  // Half of what place 700 shows, with noise, and as much that it does not.
  Landmarks image = scene(700, 12);
  for (const Landmark& other : scene(5000, 12)) image.push_back(other);
  std::vector<TemplateMatch> matches;
  index.query(image, kTemplates, matches);
  ASSERT_EQ(matches.size(), 40U);
  EXPECT_EQ(matches[0].number, 700);
  EXPECT_DOUBLE_EQ(matches[0].similarity, similarity(image, index.landmarks(700)));
  EXPECT_GT(matches[0].similarity, matches[1].similarity + 0.1);
  Stopwatch watch;
  constexpr int kRuns = 20;
  for (int i = 0; i < kRuns; ++i) index.query(image, kTemplates, matches);
  RecordProperty("ms", fmt::format("{:.3f}", watch.milliseconds() / kRuns));
  index.query(image, 700, matches);
  for (const TemplateMatch& match : matches) EXPECT_LT(match.number, 700);
  index.query(image, 0, matches);
  EXPECT_TRUE(matches.empty());
}

}  // namespace
}  // namespace penumbra::slam::brain
