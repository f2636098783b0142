// Where in a room a cell is active: its mean activity in bins of 5 cm, as neuroscience draws it.
//
//   frozen   the network is fixed and read at the centre of every bin; averaged over 4 headings with the
//            boundary factor or the paper's lateral weights, and with these after a straight run-up of 8
//            steps
//   live     activities are binned while the network learns; then, with a Gaussian G of 1 bin,
//            rate = G(sum of activities) / G(number of visits), in bins that were visited
//
// Activities below 0 (of the paper's bipolar rule) count 0.
//
// Cost: frozen 2 us a bin without run-ups; live 0.05 us a step.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "slam/brain/position/lahn.h"
#include "slam/brain/position/oscillators.h"
#include "slam/brain/position/random_walk.h"
#include "slam/brain/position/room.h"

namespace penumbra::slam::brain {

// The square of bins around a room.
struct RoomBins {
  static constexpr double kBin = 0.05;  // metres

  int size = 0;         // bins a side
  double extent = 0.0;  // metres from the middle to a side

  explicit RoomBins(const Room& room);
  Eigen::Vector2d centre(int column, int row) const;
  // The number of the bin, row * size + column, of a position in the room.
  std::size_t bin_of(const Eigen::Vector2d& position) const;
};

struct RateMap {
  int size = 0;
  std::vector<float> rate;  // row after row, from y = -extent upwards; 0 where not known
  std::vector<char> known;  // 1 in the room (frozen) or where the walk came by (live)
};

// What the frozen maps are read with, besides the network.
struct FrozenReading {
  const Room* room = nullptr;
  bool boundary_factor = false;
  WalkSettings walk;  // of the run-ups
  std::uint64_t seed = 1;
};

// A map for each cell. `oscillators` are those that the network was trained with.
std::vector<RateMap> frozen_rate_maps(const Lahn& network, const Oscillators& oscillators,
                                      const FrozenReading& reading);

class LiveRateMaps {
 public:
  LiveRateMaps(const Room& room, int cells);

  void add(const Eigen::Vector2d& position, std::span<const float> activity);
  RateMap map(int cell) const;

 private:
  RoomBins bins_;
  std::size_t cells_;
  std::vector<float> sums_;  // all cells of a bin side by side
  std::vector<float> visits_;
};

}  // namespace penumbra::slam::brain
