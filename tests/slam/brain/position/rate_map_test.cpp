#include "slam/brain/position/rate_map.h"

#include <gtest/gtest.h>

#include <vector>

#include "slam/brain/position/grid_training.h"

namespace penumbra::slam::brain {
namespace {

TEST(RoomBins, CoverTheRoom) {
  const RoomBins square{Room(RoomShape::square)}, hexagon{Room(RoomShape::hexagon)};
  EXPECT_EQ(square.size, 40);
  EXPECT_EQ(hexagon.size, 46);
  EXPECT_EQ(square.bin_of({-0.99, -0.99}), 0U);
  EXPECT_EQ(square.bin_of({0.99, 0.99}), 1599U);
  for (int row = 0; row < 40; row += 3) {
    for (int column = 0; column < 40; column += 7)
      EXPECT_EQ(square.bin_of(square.centre(column, row)), static_cast<std::size_t>(row * 40 + column));
  }
}

// A network of some cells after 10 s of a walk, and how it is read.
struct TrainedForAWhile {
  TrainedForAWhile(RoomShape shape, int cells)
      : settings(settings_of(shape, cells)),
        network(train_grid_network(settings, ring, start, 0)),
        room(shape) {
    reading.room = &room;
  }
  static GridTrainingSettings settings_of(RoomShape shape, int cells) {
    GridTrainingSettings settings;
    settings.room = shape;
    settings.seconds = 10.0;
    settings.rule.cells = cells;
    return settings;
  }

  GridTrainingSettings settings;
  HeadDirectionRing ring = HeadDirectionRing::trained(settings.ring, 1);
  Eigen::VectorXd start = Oscillators::random_start(12, 1);
  Lahn network;
  Room room;
  FrozenReading reading;
  Oscillators oscillators{ring.weights(), start, 0.5};
};

TEST(FrozenRateMaps, AreTheActivityAtTheCentres) {
  TrainedForAWhile trained(RoomShape::l_shape, 3);
  const Lahn& network = trained.network;
  const Room& room = trained.room;
  Oscillators& oscillators = trained.oscillators;
  const std::vector<RateMap> maps = frozen_rate_maps(network, oscillators, trained.reading);
  ASSERT_EQ(maps.size(), 3U);
  const RoomBins bins(room);
  Lahn reader = network.reader();
  std::vector<float> chi(24);
  for (int row = 0; row < bins.size; ++row) {
    for (int column = 0; column < bins.size; ++column) {
      const auto bin = static_cast<std::size_t>(row * bins.size + column);
      ASSERT_EQ(maps[0].known[bin] != 0, room.contains(bins.centre(column, row)));
      oscillators.place(bins.centre(column, row));
      oscillators.output(chi);
      reader.step(chi);
      for (std::size_t cell = 0; cell < 3; ++cell)
        ASSERT_EQ(maps[cell].rate[bin], maps[0].known[bin] != 0 ? reader.activity()[cell] : 0.0F);
    }
  }
}

// With the boundary factor an activity depends on the heading, so maps are means over some.
TEST(FrozenRateMaps, DependOnTheWallsWithTheBoundaryFactor) {
  TrainedForAWhile trained(RoomShape::square, 2);
  const auto maps = [&] { return frozen_rate_maps(trained.network, trained.oscillators, trained.reading); };
  const std::vector<RateMap> plain = maps();
  trained.reading.boundary_factor = true;
  const std::vector<RateMap> bounded = maps();
  EXPECT_NE(plain[0].rate, bounded[0].rate);
  EXPECT_EQ(bounded[0].rate, maps()[0].rate);
}

TEST(LiveRateMaps, AreMeansOverVisits) {
  const Room room(RoomShape::square);
  LiveRateMaps maps(room, 2);
  const RoomBins bins(room);
  const std::vector<float> low = {0.2F, -1.0F}, high = {0.6F, 0.5F};
  for (int i = 0; i < 3; ++i) {
    maps.add(bins.centre(10, 20), low);
    maps.add(bins.centre(10, 20), high);
  }
  const RateMap first = maps.map(0), second = maps.map(1);
  const std::size_t visited = 20 * 40 + 10;
  EXPECT_NEAR(first.rate[visited], 0.4F, 1e-6);
  EXPECT_NEAR(second.rate[visited], 0.25F, 1e-6);  // below 0 counts 0
  for (std::size_t bin = 0; bin < first.known.size(); ++bin) EXPECT_EQ(first.known[bin] != 0, bin == visited);
  // A neighbour is mixed in by the Gaussian: exp(-1/2) of its weight.
  maps.add(bins.centre(11, 20), low);
  const double g = 0.6065306597;
  EXPECT_NEAR(maps.map(0).rate[visited], (6 * 0.4 + g * 0.2) / (6 + g), 1e-5);
}

}  // namespace
}  // namespace penumbra::slam::brain
