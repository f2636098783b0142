// People of the office: limbs hang together, move smoothly, stay above the floor, hold what they carry.
#include <gtest/gtest.h>

#include <cmath>

#include "slam/world/acting.h"
#include "slam/world/office_builder.h"

namespace penumbra::slam::synthetic {
namespace {

using Kind = Step::Kind;

std::vector<Step> sit_rise_and_walk() {
  return {{.kind = Kind::sit, .seconds = 0.5, .place = {0.0, 0.0}, .heading = 0.4},
          {.kind = Kind::rise},
          {.kind = Kind::walk, .place = {1.5, 0.0}, .speed = 1.1},
          {.kind = Kind::grasp, .prop = 0},
          {.kind = Kind::walk, .place = {-1.0, -1.0}, .speed = 1.0},
          {.kind = Kind::stand, .seconds = 0.5}};
}

Performance performance() {
  const Prop box{.start = on_ground({{1.9, 0.1}, 0.3}), .carried = true};
  return {{.stature = 1.8, .girth = 1.0F}, sit_rise_and_walk(), 4, {box}, 1.0, 7, 12.0};
}

SE3 limb_at(const Performance& acting, Limb limb, double time) {
  return skeleton_of(acting.posture_at(time), 1.8)[static_cast<std::size_t>(limb)];
}

TEST(OfficePeople, LimbsHangTogetherAtTheirJoints) {
  const Performance acting = performance();
  struct Joint {
    Limb parent, child;
    double length;  // from the parent's joint down to the child's, in shares of the stature
  };
  const Joint joints[] = {{Limb::left_upper_arm, Limb::left_forearm, 0.186},
                          {Limb::right_forearm, Limb::right_hand, 0.146},
                          {Limb::left_thigh, Limb::left_shin, 0.245},
                          {Limb::right_shin, Limb::right_foot, 0.246}};
  for (double time = 0.0; time < 11.0; time += 0.37) {
    for (const Joint& joint : joints) {
      const Eigen::Vector3d end =
          limb_at(acting, joint.parent, time) * Eigen::Vector3d(0.0, 1.8 * joint.length, 0.0);
      EXPECT_LT((end - limb_at(acting, joint.child, time).translation).norm(), 1e-9);
    }
  }
}

TEST(OfficePeople, NothingJumps) {
  const Performance acting = performance();
  constexpr double kStep = 1.0 / 240.0;
  for (double time = 0.0; time < 11.0; time += kStep) {
    for (int limb = 0; limb < kLimbs; ++limb) {
      const SE3 from = limb_at(acting, static_cast<Limb>(limb), time),
                to = limb_at(acting, static_cast<Limb>(limb), time + kStep);
      ASSERT_LT((to.translation - from.translation).norm() / kStep, 6.0) << "limb " << limb << " at " << time;
      ASSERT_LT((from.inverse() * to).angle() / kStep, 14.0) << "limb " << limb << " at " << time;
    }
    const SE3 from = acting.prop_at(0, time), to = acting.prop_at(0, time + kStep);
    ASSERT_LT((to.translation - from.translation).norm() / kStep, 5.0) << "the box at " << time;
  }
}

TEST(OfficePeople, FeetStandOnTheFloorAndAPersonSitsThenWalks) {
  const Performance acting = performance();
  double farthest = 0.0;
  for (double time = 0.0; time < 11.0; time += 0.1) {
    double lowest = -10.0;
    for (const Limb foot : {Limb::left_foot, Limb::right_foot})
      lowest = std::max(lowest, limb_at(acting, foot, time).translation.y());
    // Ankles are .039 h above the soles; the floor is y = 0.
    EXPECT_LT(lowest, 0.0) << "at " << time;
    if (acting.state_at(time).seated == 0.0) {
      EXPECT_NEAR(lowest, -0.039 * 1.8, 0.02) << "at " << time;
    }
    farthest = std::max(farthest, limb_at(acting, Limb::pelvis, time).translation.x());
  }
  EXPECT_NEAR(limb_at(acting, Limb::pelvis, 0.0).translation.y(), -kSeatHeight - 0.075 * 1.8, 0.03);
  EXPECT_NEAR(limb_at(acting, Limb::pelvis, 0.0).translation.x(), 0.0, 1e-9);  // over the chair
  EXPECT_GT(farthest, 1.2);
}

TEST(OfficePeople, ACarriedBoxStaysBeforeTheChest) {
  const Performance acting = performance();
  EXPECT_TRUE(acting.prop_moves(0));
  EXPECT_LT((acting.prop_at(0, 0.0).translation - Eigen::Vector3d(1.9, 0.0, 0.1)).norm(), 1e-6);
  for (double time = 8.0; time < 11.0; time += 0.5) {
    const SE3 in_chest = limb_at(acting, Limb::pelvis, time).inverse() * acting.prop_at(0, time);
    EXPECT_NEAR(in_chest.translation.z(), 0.42, 0.1);
    EXPECT_NEAR(in_chest.translation.x(), 0.0, 0.1);
  }
}

TEST(OfficePeople, TheSameSeedActsTheSame) {
  const Performance a = performance(), b = performance();
  EXPECT_EQ(limb_at(a, Limb::left_hand, 6.3).translation, limb_at(b, Limb::left_hand, 6.3).translation);
}

TEST(OfficePeople, WalkersLeaveTheirChairsAndSittersDoNot) {
  for (const People people : {People::sitting, People::walking}) {
    const World world = build_office({}, people, 10.0, 4);
    int limbs = 0;
    for (const Object& object : world.objects) {
      if (object.object_class != ObjectClass::person) continue;
      ++limbs;
      EXPECT_TRUE(object.motion.moves);
      double way = 0.0;
      for (double time = 0.0; time < 10.0; time += 0.1) {
        way += (placement_at(world, object, time + 0.1).translation -
                placement_at(world, object, time).translation)
                   .norm();
      }
      if (people == People::walking) {
        EXPECT_GT(way, 2.5);
      }
    }
    EXPECT_EQ(limbs, 2 * kLimbs);
  }
}

}  // namespace
}  // namespace penumbra::slam::synthetic
