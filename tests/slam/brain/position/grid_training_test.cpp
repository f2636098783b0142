#include "slam/brain/position/grid_training.h"

#include <gtest/gtest.h>

#include <limits>

#include "nn/base/error.h"
#include "nn/base/parallel.h"

namespace penumbra::slam::brain {
namespace {

GridTrainingSettings quick_training() {
  GridTrainingSettings settings;
  settings.seconds = 50.0;
  settings.modules = 2;
  return settings;
}

TEST(GridTraining, RepeatsForASeedOnAnyNumberOfThreads) {
  const int threads = thread_count();
  set_thread_count(1);
  const GridCode one = train_grid_code(quick_training());
  set_thread_count(2);
  const GridCode two = train_grid_code(quick_training());
  set_thread_count(threads);
  EXPECT_EQ(one.directions, two.directions);
  for (std::size_t m = 0; m < 2; ++m) {
    EXPECT_EQ(one.modules[m].weights, two.modules[m].weights);
    EXPECT_EQ(one.modules[m].start, two.modules[m].start);
  }
  EXPECT_NE(one.modules[0].weights, one.modules[1].weights);
}

TEST(GridTraining, LearnsOnlyWhenItIsToldTo) {
  const GridCode trained = train_grid_code(quick_training()), raw = train_grid_code(quick_training(), true);
  EXPECT_LE(raw.modules[0].weights.cwiseAbs().maxCoeff(), 0.1F);
  EXPECT_GT(trained.modules[0].weights.norm(), 1.2F * raw.modules[0].weights.norm());
  EXPECT_EQ(trained.modules[0].start, raw.modules[0].start);
}

TEST(GridTraining, TellsTheWalkAtEveryStep) {
  const GridTrainingSettings settings = quick_training();
  const Room room(settings.room);
  const HeadDirectionRing ring = HeadDirectionRing::trained(settings.ring, 1);
  int steps = 0;
  double last = 0.0;
  train_grid_network(settings, ring, Oscillators::random_start(12, 1), 0,
                     [&](const RandomWalk& walk, const Lahn& network, double seconds) {
                       ASSERT_TRUE(room.contains(walk.position()));
                       ASSERT_EQ(network.activity().size(), 25U);
                       ++steps;
                       last = seconds;
                     });
  EXPECT_EQ(steps, 1000);
  EXPECT_DOUBLE_EQ(last, 50.0);
}

TEST(GridTraining, RefusesToReturnWhatIsNotFinite) {
  GridTrainingSettings settings = quick_training();
  settings.rule.first_weight = std::numeric_limits<float>::infinity();
  EXPECT_THROW(train_grid_code(settings), Error);
}

}  // namespace
}  // namespace penumbra::slam::brain
