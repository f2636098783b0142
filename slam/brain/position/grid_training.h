// Trains the grid cells of one module, or of several, on a random walk through a room.
//
//   walk -> heading and speed -> ring -> oscillators (wavelength 0.5 m) -> LAHN, which learns at every step
//
// Module m has start phases, first weights and a walk of its own, of seed + m; the ring is that of seed.
//
// Cost: 1 us a step: 20 ms for 1000 seconds.
#pragma once

#include <cstdint>
#include <functional>

#include "slam/brain/position/grid_code.h"
#include "slam/brain/position/random_walk.h"
#include "slam/brain/position/room.h"

namespace penumbra::slam::brain {

struct GridTrainingSettings {
  RoomShape room = RoomShape::square;
  double seconds = 1000.0;
  std::uint64_t seed = 1;
  bool boundary_factor = false;  // R_p
  int modules = 1;
  double wavelength = 0.5;  // metres
  LahnSettings rule;
  RingSettings ring;
  WalkSettings walk;
};

// After every step: the walk and the network, and the time since the start.
using WatchTraining = std::function<void(const RandomWalk& walk, const Lahn& network, double seconds)>;

// One network, as module `module` of the settings. Its weights may be anything: ask finite().
Lahn train_grid_network(const GridTrainingSettings& settings, const HeadDirectionRing& ring,
                        const Eigen::VectorXd& start, int module, const WatchTraining& watch = {});

// All modules, each at the wavelength of the settings. `untrained` leaves out the learning. Error where a
// module's weights are not finite.
GridCode train_grid_code(const GridTrainingSettings& settings, bool untrained = false);

}  // namespace penumbra::slam::brain
