#include "slam/brain/map/relaxation.h"

#include <gtest/gtest.h>

#include "nn/base/counter_random.h"
#include "nn/base/error.h"

namespace penumbra::slam::brain {
namespace {

Node node_at(const PlanePose& pose) {
  Node node;
  node.pose = pose;
  return node;
}

Link link_between(int from, int to, const PlanePose& motion, bool recalled = false) {
  Link link;
  link.from = from;
  link.to = to;
  link.motion = motion;
  link.recalled = recalled;
  return link;
}

// A drive round a square of 4 x `side` nodes, felt with a turn of 1.05 of what it was, closed by one link.
CognitiveMap square(int side, double felt_turns = 1.05) {
  CognitiveMap map;
  PlanePose pose;
  map.add(node_at(pose));
  constexpr double kQuarter = 1.5707963267948966;
  for (int i = 1; i < 4 * side; ++i) {
    const PlanePose step{1.0, 0.0, i % side == 0 ? kQuarter * felt_turns : 0.0};
    pose = pose * step;
    map.add(node_at(pose));
    map.add(link_between(i - 1, i, step));
  }
  map.add(link_between(4 * side - 1, 0, {1.0, 0.0, kQuarter}, true));
  return map;
}

double error_of(const CognitiveMap& map, int side) {
  double error = 0.0;
  for (int i = 0; i < map.size(); ++i) {
    const int edge = i / side, along = i % side;
    const double s = side, a = along;
    const double x[] = {a, s, s - a, 0.0}, y[] = {0.0, a, s, s - a};
    error = std::max(error, std::hypot(map.node(i).pose.x - x[edge], map.node(i).pose.y - y[edge]));
  }
  return error;
}

TEST(Relaxation, ByHandThreeNodesOnALine) {
  // Felt: 0 -> 1 is 1 m, 1 -> 2 is 1 m; seen again: 0 -> 2 is 2.3 m. Each link gives a third of 0.3 m.
  CognitiveMap map;
  for (const double x : {0.0, 1.0, 2.0}) map.add(node_at({x, 0.0, 0.0}));
  map.add(link_between(0, 1, {1.0, 0.0, 0.0}));
  map.add(link_between(1, 2, {1.0, 0.0, 0.0}));
  map.add(link_between(0, 2, {2.3, 0.0, 0.0}, true));
  for (const RelaxationMode mode : {RelaxationMode::paper, RelaxationMode::mean, RelaxationMode::settled}) {
    CognitiveMap own = map;
    const RelaxationSummary summary = relax(own, {.mode = mode});
    EXPECT_TRUE(summary.settled);
    EXPECT_NEAR(own.node(0).pose.x, 0.0, 1e-12);
    EXPECT_NEAR(own.node(1).pose.x, 1.1, 1e-3);
    EXPECT_NEAR(own.node(2).pose.x, 2.2, 1e-3);
  }
}

TEST(Relaxation, AWrongTurnIsRepairedWhereHeadingsRelax) {
  CognitiveMap paper = square(10), settled = paper;
  const double before = error_of(paper, 10);
  relax(paper, {.mode = RelaxationMode::paper, .sweeps = 20000});
  relax(settled, {.mode = RelaxationMode::settled});
  EXPECT_LT(error_of(settled, 10), 0.35 * before);
  EXPECT_LT(error_of(settled, 10), 0.7 * error_of(paper, 10));
}

TEST(Relaxation, MeanSweepsLeadWhereSettledIsAtOnce) {
  // With the same weight for all links, and turns that were felt right, both have one solution.
  CognitiveMap swept = square(5, 1.0);
  for (int i = 1; i < swept.size(); ++i) {
    PlanePose& pose = swept.node(i).pose;
    pose.x += 0.3 * (counter_uniform(7, static_cast<std::uint64_t>(i)) - 0.5);
    pose.y += 0.3 * (counter_uniform(8, static_cast<std::uint64_t>(i)) - 0.5);
  }
  CognitiveMap settled = swept;
  EXPECT_TRUE(relax(swept, {.mode = RelaxationMode::mean, .sweeps = 100000, .settled = 1e-9}).settled);
  relax(settled, {.mode = RelaxationMode::settled, .iterations = 20});
  for (int i = 0; i < swept.size(); ++i) {
    EXPECT_NEAR(swept.node(i).pose.x, settled.node(i).pose.x, 1e-5);
    EXPECT_NEAR(swept.node(i).pose.y, settled.node(i).pose.y, 1e-5);
  }
}

// rho times the sum of the pulls: a node of four links is thrown beyond its neighbours again and again.
TEST(Relaxation, TheLetterFliesApartWhereANodeHasFourLinks) {
  CognitiveMap map;
  for (int i = 0; i < 12; ++i) map.add(node_at({0.1 * i * i, 0.0, 0.0}));
  for (int i = 0; i < 12; ++i) {
    for (const int step : {1, 2}) {
      map.add(link_between(i, (i + step) % 12, {0.01, 0.0, 0.0}));
    }
  }
  const double before = map.node(11).pose.x;
  const RelaxationSummary summary = relax(map, {.mode = RelaxationMode::paper});
  EXPECT_FALSE(summary.settled);
  EXPECT_TRUE(summary.flew_apart);
  EXPECT_EQ(map.node(11).pose.x, before) << "it is given back as it was";
  EXPECT_TRUE(relax(map, {.mode = RelaxationMode::mean, .sweeps = 20000}).settled);
}

TEST(Relaxation, LeavesAMapWithoutLinksAndOneThatAgrees) {
  CognitiveMap map;
  map.add(node_at({}));
  EXPECT_TRUE(relax(map).settled);
  map.add(node_at({2.0, 0.0, 0.0}));
  EXPECT_TRUE(relax(map).settled);
  map.add(link_between(0, 1, {2.0, 0.0, 0.0}));
  EXPECT_NEAR(relax(map).largest_move, 0.0, 1e-12);
  EXPECT_NEAR(disagreement(map), 0.0, 1e-12);
}

TEST(Relaxation, ANodeThatNothingTiesStays) {
  CognitiveMap map = square(5);
  const int lone = map.add(node_at({50.0, 50.0, 1.0}));
  relax(map);
  EXPECT_NEAR(map.node(lone).pose.x, 50.0, 1e-9);
}

TEST(Relaxation, TurnsAcrossPiAreSmall) {
  CognitiveMap map;
  map.add(node_at({0.0, 0.0, 0.0}));
  map.add(node_at({1.0, 0.0, 3.13}));
  map.add(link_between(0, 1, {1.0, 0.0, -3.13}));
  relax(map);
  EXPECT_NEAR(std::abs(map.node(1).pose.heading), 3.13, 1e-6);
}

TEST(CognitiveMap, CountsHops) {
  const CognitiveMap map = square(5);
  EXPECT_EQ(map.hops(0, 0, 3), 0);
  EXPECT_EQ(map.hops(0, 3, 5), 3);
  EXPECT_EQ(map.hops(0, 19, 5), 1) << "by the link that was recalled";
  EXPECT_EQ(map.hops(0, 10, 4), 5) << "more than asked for";
}

TEST(CognitiveMap, RefusesLinksToNowhere) {
  CognitiveMap map = square(2);
  EXPECT_THROW(map.add(link_between(1, 1, {})), UsageError);
  EXPECT_THROW(map.add(link_between(0, 99, {})), UsageError);
  EXPECT_THROW(map.add(link_between(-1, 0, {})), UsageError);
  EXPECT_THROW(relaxation_mode("soft"), UsageError);
}

}  // namespace
}  // namespace penumbra::slam::brain
