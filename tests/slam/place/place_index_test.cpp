#include "slam/place/place_index.h"

#include <gtest/gtest.h>

#include "nn/base/counter_random.h"
#include "slam/map/map.h"

namespace penumbra::slam {
namespace {

constexpr int kFeatures = 150;

// Descriptors of place `place`, each bit of them wrong with probability `noise`.
std::shared_ptr<FrameFeatures> view_of(int place, double noise, std::uint64_t seed,
                                       int features = kFeatures) {
  auto view = std::make_shared<FrameFeatures>();
  for (int i = 0; i < features; ++i) {
    Descriptor d{};
    for (std::size_t b = 0; b < kDescriptorBits; ++b) {
      const std::uint64_t at = static_cast<std::uint64_t>(i) * kDescriptorBits + b;
      const bool bit = counter_uniform(static_cast<std::uint64_t>(place) + 1000, at) < 0.5;
      const bool flip = counter_uniform(seed, at) < noise;
      d[b / 64] |= static_cast<std::uint64_t>(bit != flip) << (b % 64);
    }
    view->left.descriptors.push_back(d);
    view->left.keypoints.push_back({10.0F + static_cast<float>(i % 40), 10.0F + static_cast<float>(i / 40)});
  }
  const std::size_t n = static_cast<std::size_t>(features);
  view->u_right.assign(n, 5.0F);
  view->depth.assign(n, 10.0F);
  view->colour.assign(n, {});
  return view;
}

// A map whose keyframe `i` shows place `i`; every feature shows a point.
class Places {
 public:
  Places() : map(StereoCamera(), {1.0}) {}
  KeyFrame* add(const std::shared_ptr<FrameFeatures>& features) {
    KeyFrame* keyframe = map.add_keyframe(static_cast<int>(map.keyframes().size()), 0.0, SE3{}, features);
    for (int i = 0; i < features->size(); ++i) map.add_point({0.0, 0.0, 10.0}, keyframe, i);
    return keyframe;
  }
  Map map;
};

TEST(PlaceIndex, FindsAPlaceAgainThroughNoise) {
  Places places;
  PlaceIndex index;
  for (int place = 0; place < 60; ++place) {
    index.insert(places.add(view_of(place, 0.03, static_cast<std::uint64_t>(place))));
  }
  EXPECT_EQ(index.keyframes(), 60);
  EXPECT_EQ(index.descriptors(), 60U * kFeatures);
  for (int place = 0; place < 60; ++place) {
    const auto candidates = index.query(*view_of(place, 0.03, static_cast<std::uint64_t>(500 + place)), 3);
    ASSERT_FALSE(candidates.empty()) << place;
    EXPECT_EQ(candidates.front().keyframe->id, place);
  }
}

TEST(PlaceIndex, FindsNothingInAPlaceThatIsNew) {
  Places places;
  PlaceIndex index;
  for (int place = 0; place < 60; ++place) {
    index.insert(places.add(view_of(place, 0.03, static_cast<std::uint64_t>(place))));
  }
  for (int place = 100; place < 120; ++place) {
    EXPECT_TRUE(index.query(*view_of(place, 0.03, 1), 3).empty());
  }
}

TEST(PlaceIndex, ErasedAndExcludedKeyframesAreNotFound) {
  Places places;
  PlaceIndex index;
  std::vector<KeyFrame*> keyframes;
  for (int place = 0; place < 20; ++place) keyframes.push_back(places.add(view_of(place, 0.0, 1)));
  for (KeyFrame* keyframe : keyframes) index.insert(keyframe);
  const auto view = view_of(7, 0.02, 2);
  EXPECT_TRUE(index.query(*view, 3, [](const KeyFrame& k) { return k.id == 7; }).empty());
  ASSERT_EQ(index.query(*view, 3).size(), 1U);
  places.map.erase_keyframe(keyframes[7]);
  EXPECT_TRUE(index.query(*view, 3).empty());
  index.remove_erased();
  EXPECT_EQ(index.keyframes(), 19);
  EXPECT_EQ(index.descriptors(), 19U * kFeatures);
  EXPECT_TRUE(index.query(*view, 3).empty());
  ASSERT_EQ(index.query(*view_of(8, 0.02, 2), 3).size(), 1U);
}

TEST(PlaceIndex, CovisibleKeyframesAreOnePlace) {
  Places places;
  PlaceIndex index;
  KeyFrame* a = places.add(view_of(0, 0.01, 1));
  KeyFrame* b = places.add(view_of(1, 0.01, 1));
  KeyFrame* c = places.map.add_keyframe(2, 0.0, SE3{}, view_of(0, 0.02, 3));
  for (int i = 0; i < kFeatures; ++i) places.map.add_observation(a->points[std::size_t(i)], c, i);
  places.map.update_covisibility(c);
  for (KeyFrame* keyframe : {a, b, c}) index.insert(keyframe);
  const auto candidates = index.query(*view_of(0, 0.01, 4), 3);
  ASSERT_EQ(candidates.size(), 1U);
  EXPECT_TRUE(candidates.front().keyframe == a || candidates.front().keyframe == c);
}

TEST(PlaceIndex, KeyframesWithoutFeaturesOrPointsOrTwiceChangeNothing) {
  Places places;
  PlaceIndex index;
  EXPECT_TRUE(index.query(*view_of(0, 0.0, 1), 3).empty());
  index.insert(places.map.add_keyframe(0, 0.0, SE3{}, view_of(0, 0.0, 1, 0)));
  index.insert(places.map.add_keyframe(1, 0.0, SE3{}, view_of(1, 0.0, 1)));
  EXPECT_EQ(index.keyframes(), 0);
  KeyFrame* keyframe = places.add(view_of(2, 0.0, 1));
  index.insert(keyframe);
  index.insert(keyframe);
  EXPECT_EQ(index.descriptors(), std::size_t{kFeatures});
  EXPECT_TRUE(index.query(*view_of(0, 0.0, 1, 0), 3).empty());
  EXPECT_EQ(index.query(*view_of(2, 0.0, 1), 0).size(), 0U);
}

TEST(PlaceIndex, EqualDescriptorsThatNoBitPartsAreTaken) {
  Places places;
  PlaceIndex index;
  auto same = view_of(3, 0.0, 1, 500);
  for (Descriptor& d : same->left.descriptors) d = same->left.descriptors[0];
  KeyFrame* keyframe = places.add(same);
  index.insert(keyframe);
  EXPECT_EQ(index.query(*same, 1).front().keyframe, keyframe);
}

}  // namespace
}  // namespace penumbra::slam
