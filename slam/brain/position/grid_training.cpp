#include "slam/brain/position/grid_training.h"

#include <cmath>

#include "nn/base/error.h"
#include "nn/base/parallel.h"

namespace penumbra::slam::brain {

Lahn train_grid_network(const GridTrainingSettings& settings, const HeadDirectionRing& ring,
                        const Eigen::VectorXd& start, int module, const WatchTraining& watch) {
  const std::uint64_t seed = settings.seed + static_cast<std::uint64_t>(module);
  const Room room(settings.room);
  RandomWalk walk(room, settings.walk, seed);
  HeadDirectionRing heading = ring;
  heading.set_heading(walk.heading());
  Oscillators oscillators(ring.weights(), start, settings.wavelength);
  oscillators.place(walk.position());
  Lahn network(oscillators.outputs(), settings.rule, seed);
  std::vector<float> chi(static_cast<std::size_t>(oscillators.outputs()));
  const double step = settings.walk.step;
  const auto steps = static_cast<long>(std::lround(settings.seconds / step));
  for (long i = 0; i < steps; ++i) {
    const Eigen::Vector2d before = walk.position();
    walk.step();
    heading.turn(walk.turn_rate(), step);
    oscillators.advance(heading, (walk.position() - before).norm() / step, step);
    oscillators.output(chi);
    if (settings.boundary_factor) {
      apply_boundary_factor(boundary_factor(room.wall_ahead(walk.position(), walk.heading())), chi);
    }
    network.step(chi);
    network.learn(chi);
    if (watch) watch(walk, network, static_cast<double>(i + 1) * step);
  }
  return network;
}

GridCode train_grid_code(const GridTrainingSettings& settings, bool untrained) {
  GridTrainingSettings used = settings;
  if (untrained) used.seconds = 0.0;
  const HeadDirectionRing ring = HeadDirectionRing::trained(settings.ring, settings.seed);
  GridCode code{ring.weights(), settings.rule, {}};
  code.modules.resize(static_cast<std::size_t>(settings.modules));
  parallel_for(settings.modules, 1, [&](int m) {
    const Eigen::VectorXd start =
        Oscillators::random_start(ring.directions(), settings.seed + static_cast<std::uint64_t>(m));
    const Lahn network = train_grid_network(used, ring, start, m);
    if (!network.finite()) throw Error("grid cells: the weights are no longer finite numbers");
    code.modules[static_cast<std::size_t>(m)] = {settings.wavelength, start, network.forward()};
  });
  return code;
}

}  // namespace penumbra::slam::brain
