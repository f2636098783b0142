#include "slam/place/constellation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "nn/base/counter_random.h"

namespace penumbra::slam {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const StereoCamera kCamera = {
    .fx = 360.0, .fy = 360.0, .cx = 310.0, .cy = 94.0, .baseline = 0.54, .width = 620, .height = 188};

SeenObject standing(int number, const Eigen::Vector3d& position, const std::string& class_name = "car") {
  return {number, class_name, position, {}, true};
}

// Positions on both sides of a street without any order in them.
Constellation street(int objects, std::uint64_t seed) {
  Constellation street;
  for (int i = 0; i < objects; ++i) {
    const auto uniform = [&](std::uint64_t k) {
      return counter_uniform(seed, 8 * static_cast<std::uint64_t>(i) + k);
    };
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    street.push_back(standing(i, {side * (4.0 + 3.0 * uniform(0)), 1.0, 7.0 * i + 5.0 * uniform(1)}));
  }
  return street;
}

SE3 motion(std::uint64_t seed) {
  Vector6d x;
  for (std::uint64_t k = 0; k < 6; ++k)
    x[static_cast<int>(k)] = (k < 3 ? 8.0 : 1.0) * (counter_uniform(seed, k) - 0.5);
  return SE3::exp(x);
}

// What the image sees of `place` after `T`: with other numbers, in another order, `noise` metres off at most.
Constellation seen_after(const SE3& T, const Constellation& place, double noise, std::uint64_t seed) {
  Constellation image;
  for (std::size_t i = 0; i < place.size(); ++i) {
    SeenObject object = place[(i * 5 + seed) % place.size()];
    for (int k = 0; k < 3; ++k)
      object.position[k] +=
          noise * (2.0 * counter_uniform(seed, 16 * i + static_cast<std::uint64_t>(k)) - 1.0);
    object.position = T * object.position;
    object.number += 1000;
    image.push_back(object);
  }
  return image;
}

ConstellationAgreement compare(const Constellation& image, const Constellation& place, const SE3& T = {}) {
  return compare_constellations(kCamera, image, place, T, {});
}

bool supported(const Constellation& image, const Constellation& place, const SE3& T = {}) {
  return supports_place(compare(image, place, T), {});
}

TEST(Constellation, AgreesUnderAnyMotionAndInAnyOrder) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Constellation place = street(7, seed);  // 5 does not divide 7: each object once
    const SE3 T = motion(seed);
    const ConstellationAgreement agreement = compare(seen_after(T, place, 0.3, seed), place, T);
    EXPECT_EQ(agreement.agreeing, 7);
    EXPECT_EQ(agreement.contradicted, 0);
    EXPECT_EQ(compare(seen_after(T, place, 0.3, seed + 1), place, T).agreeing, 7);
    // Told another motion, it does not.
    const SE3 wrong = motion(seed + 100) * T;
    EXPECT_FALSE(supported(seen_after(T, place, 0.0, seed), place, wrong)) << seed;
  }
}

TEST(Constellation, SupportsAPlaceByThreeObjects) {
  const Constellation place = {standing(0, {-4.0, 1.0, 6.0}), standing(1, {5.0, 1.0, 11.0}),
                               standing(2, {-5.0, 1.0, 19.0})};
  EXPECT_TRUE(supported(seen_after(SE3{}, place, 0.2, 1), place));
  Constellation fewer = place;
  fewer.pop_back();
  EXPECT_FALSE(supported(seen_after(SE3{}, fewer, 0.2, 1), place));
}

TEST(Constellation, WantsTheSameClass) {
  const Constellation place = street(7, 3);
  Constellation image = seen_after(SE3{}, place, 0.0, 3);
  image[2].class_name = "truck";
  EXPECT_EQ(compare(image, place).agreeing, 6);
  for (SeenObject& object : image) object.class_name = "truck";
  EXPECT_EQ(compare(image, place).agreeing, 0);
}

TEST(Constellation, PairsOneToOneAndTheNearestFirst) {
  const Constellation place = {standing(0, {0.0, 0.0, 10.0})};
  const Constellation image = {standing(1, {0.5, 0.0, 10.0}), standing(2, {0.2, 0.0, 10.0})};
  EXPECT_EQ(compare(image, place).agreeing, 1);
  EXPECT_EQ(compare(place, image).agreeing, 1);
}

TEST(Constellation, ToleratesMoreFarAway) {
  const auto agreeing = [](double depth, double apart) {
    return compare({standing(1, {0.0, 0.0, depth})}, {standing(0, {apart, 0.0, depth})}).agreeing;
  };
  EXPECT_EQ(agreeing(4.0, 1.15), 1);
  EXPECT_EQ(agreeing(4.0, 1.25), 0);
  EXPECT_EQ(agreeing(20.0, 1.95), 1);
  EXPECT_EQ(agreeing(20.0, 2.05), 0);
}

TEST(Constellation, IgnoresWhatIsNotProvenToStand) {
  const Constellation place = street(6, 4);
  Constellation image = seen_after(SE3{}, place, 0.0, 4);
  for (SeenObject& object : image) object.stands = false;
  EXPECT_EQ(compare(image, place).agreeing, 0);
  EXPECT_EQ(compare(place, image).agreeing, 0);
}

TEST(Constellation, IgnoresWhatWasFollowedFromThere) {
  const Constellation place = street(6, 5);
  EXPECT_EQ(compare(place, place).agreeing, 0);
}

// Six cars on each side, one as far from the next as that from the one after it.
TEST(Constellation, DoesNotTrustRowsOfParkedCars) {
  Constellation place;
  for (int i = 0; i < 12; ++i)
    place.push_back(standing(i, {i % 2 == 0 ? 4.4 : -4.4, 1.0, 5.0 + 5.8 * (i / 2)}));
  const Constellation image = seen_after(SE3{}, place, 0.2, 1);
  const ConstellationAgreement agreement = compare(image, place);
  EXPECT_EQ(agreement.agreeing, 12);
  EXPECT_GE(agreement.rival, 10);
  // One car on is as good a place, or nearly so.
  SE3 next;
  next.translation.z() = 5.8;
  EXPECT_EQ(compare(image, place, next).agreeing, 10);
  EXPECT_FALSE(supported(image, place, next));
  const Constellation one_row = {place[0], place[2], place[4], place[6]};
  EXPECT_FALSE(supported(seen_after(SE3{}, one_row, 0.2, 1), one_row));
}

TEST(Constellation, DoesNotTrustALine) {
  const Constellation place = {standing(0, {4.4, 1.0, 5.0}), standing(1, {4.5, 1.0, 11.0}),
                               standing(2, {4.4, 1.0, 21.0}), standing(3, {4.6, 1.0, 35.0})};
  const Constellation image = seen_after(SE3{}, place, 0.0, 3);
  EXPECT_EQ(compare(image, place).agreeing, 4);
  EXPECT_LT(compare(image, place).spread, 0.2);
  EXPECT_FALSE(supported(image, place));
}

TEST(Constellation, CountsWhatShouldBeSeenAndIsNot) {
  Constellation place = {standing(0, {1.0, 0.5, 10.0})};
  EXPECT_EQ(compare({}, place).contradicted, 0) << "shown by its neighbours alone";
  place[0].region = {330, 100, 30, 20};
  EXPECT_EQ(compare({}, place).contradicted, 1);
  SeenObject other{7, "person", {1.0, 0.5, 6.0}, {300, 80, 60, 60}, false};
  EXPECT_EQ(compare({other}, place).contradicted, 0) << "hidden";
  other.position.z() = 15.0;
  EXPECT_EQ(compare({other}, place).contradicted, 1) << "hidden by nothing that is behind it";
  other = {7, "truck", {1.5, 0.5, 11.0}, {}, false};
  EXPECT_EQ(compare({other}, place).contradicted, 0) << "something is there";
  for (const Eigen::Vector3d& unseen : {Eigen::Vector3d(1.0, 0.5, 30.0), Eigen::Vector3d(1.0, 0.5, 1.0),
                                        Eigen::Vector3d(1.0, 0.5, -10.0), Eigen::Vector3d(12.0, 0.5, 10.0)}) {
    place[0].position = unseen;
    EXPECT_EQ(compare({}, place).contradicted, 0) << unseen.transpose();
  }
}

TEST(Constellation, ContradictionsOutweighAgreement) {
  const ConstellationSettings settings;
  EXPECT_TRUE(supports_place({.agreeing = 4, .rival = 1, .contradicted = 2, .spread = 3.0}, settings));
  EXPECT_FALSE(supports_place({.agreeing = 4, .rival = 1, .contradicted = 3, .spread = 3.0}, settings));
  EXPECT_FALSE(supports_place({.agreeing = 4, .rival = 3, .contradicted = 0, .spread = 3.0}, settings));
  EXPECT_FALSE(supports_place({.agreeing = 4, .rival = 1, .contradicted = 0, .spread = 0.5}, settings));
  ConstellationSettings off;
  off.enabled = false;
  EXPECT_FALSE(supports_place({.agreeing = 4, .rival = 1, .contradicted = 0, .spread = 3.0}, off));
}

TEST(Constellation, SaysNothingAboutNothing) {
  const Constellation place = street(6, 6);
  EXPECT_EQ(compare({}, {}).agreeing, 0);
  EXPECT_EQ(compare({}, place).agreeing, 0);
  EXPECT_EQ(compare(place, {}).agreeing, 0);
  EXPECT_FALSE(supported({}, {}));
  Constellation image = seen_after(SE3{}, place, 0.0, 6);
  image[0].position.x() = kNan;
  image[1].position.z() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(compare(image, place).agreeing, 4);
  EXPECT_EQ(compare(place, image).agreeing, 4);
  SE3 nowhere;
  nowhere.translation.setConstant(kNan);
  EXPECT_EQ(compare(image, place, nowhere).agreeing, 0);
  EXPECT_FALSE(supported(image, place, nowhere));
}

TEST(Constellation, TakesObjectsFromTheKeyframeAndItsNeighbours) {
  KeyFrame here, near, far, farther;
  near.T_cw.translation.z() = -2.0;  // two metres on
  far.T_cw.translation.z() = -4.0;
  near.frame_index = 1;
  far.frame_index = 2;
  here.objects = {standing(3, {1.0, 0.0, 10.0})};
  near.objects = {standing(3, {1.0, 0.0, 9.0}), standing(1, {2.0, 0.0, 4.0})};
  near.objects[1].region = {1, 1, 5, 5};
  near.objects[1].stands = false;
  far.objects = {standing(1, {2.0, 0.0, 2.4})};
  farther.objects = {standing(9, {0.0, 0.0, 5.0})};
  here.covisibles = {{&near, 90}, {&far, 60}, {&farther, 30}};
  const Constellation around = constellation_around(here, 2);
  ASSERT_EQ(around.size(), 2U);
  EXPECT_EQ(around[0].number, 1);
  EXPECT_NEAR(around[0].position.z(), 6.2, 1e-12);
  EXPECT_TRUE(around[0].stands) << "the newest that is known counts";
  EXPECT_TRUE(around[0].region.empty());
  EXPECT_EQ(around[1].number, 3);
  EXPECT_NEAR(around[1].position.z(), 10.0, 1e-12);
  EXPECT_EQ(count_standing(around), 2);
  EXPECT_TRUE(constellation_around(KeyFrame{}, 10).empty());
}

}  // namespace
}  // namespace penumbra::slam
