#include "slam/brain/position/grid_measurement.h"

#include <cmath>

namespace penumbra::slam::brain {

namespace {

// Share of the pairs of columns whose (absolute) cosine is above `limit`.
double alike_pairs(Eigen::MatrixXf columns, float limit, bool absolute) {
  for (auto column : columns.colwise()) column.normalize();
  const Eigen::MatrixXf cosines = columns.transpose() * columns;
  long pairs = 0, alike = 0;
  for (Eigen::Index i = 0; i < cosines.cols(); ++i) {
    for (Eigen::Index k = 0; k < i; ++k, ++pairs) {
      alike += (absolute ? std::abs(cosines(i, k)) : cosines(i, k)) > limit;
    }
  }
  return pairs == 0 ? 0.0 : static_cast<double>(alike) / static_cast<double>(pairs);
}

// A column a map, without its mean.
Eigen::MatrixXf known_rates(const std::vector<RateMap>& maps) {
  Eigen::MatrixXf columns(static_cast<Eigen::Index>(maps.front().rate.size()),
                          static_cast<Eigen::Index>(maps.size()));
  for (std::size_t i = 0; i < maps.size(); ++i) {
    const RateMap& map = maps[i];
    const Eigen::Map<const Eigen::ArrayXf> rate(map.rate.data(), columns.rows());
    const Eigen::ArrayXf known =
        Eigen::Map<const Eigen::Array<char, Eigen::Dynamic, 1>>(map.known.data(), columns.rows())
            .cast<float>();
    columns.col(static_cast<Eigen::Index>(i)) = (rate - rate.sum() / known.sum()) * known;
  }
  return columns;
}

void score_maps(const std::vector<RateMap>& maps, double spacing, std::vector<double>& fixed,
                std::vector<double>& best) {
  const Gridness gridness(autocorrelogram(maps.front()).radius);
  for (const RateMap& map : maps) {
    const GridnessScores scores = gridness.score(autocorrelogram(map), spacing);
    fixed.push_back(scores.fixed);
    best.push_back(scores.best);
  }
}

}  // namespace

GridMeasurement measure_grid_cells(const GridTrainingSettings& settings, bool untrained) {
  GridTrainingSettings used = settings;
  if (untrained) {  // the same walk, for the live maps
    used.rule.forward_rate = used.rule.lateral_rate = 0.0F;
  }
  const Room room(settings.room);
  const HeadDirectionRing ring = HeadDirectionRing::trained(settings.ring, settings.seed);
  const Eigen::VectorXd start = Oscillators::random_start(ring.directions(), settings.seed);
  const Oscillators oscillators(ring.weights(), start, settings.wavelength);
  GridMeasurement result;
  LiveRateMaps live(room, settings.rule.cells);
  const Lahn network = train_grid_network(used, ring, start, 0,
                                          [&](const RandomWalk& walk, const Lahn& learning, double seconds) {
                                            if (seconds > 0.5 * settings.seconds)
                                              live.add(walk.position(), learning.activity());
                                          });
  result.finite = network.finite();
  if (!result.finite) return result;
  FrozenReading reading;
  reading.room = &room;
  reading.boundary_factor = settings.boundary_factor;
  reading.walk = settings.walk;
  reading.seed = settings.seed;
  result.frozen = frozen_rate_maps(network, oscillators, reading);
  for (int cell = 0; cell < settings.rule.cells; ++cell) result.live.push_back(live.map(cell));
  const double spacing = 2.0 / std::sqrt(3.0) * settings.wavelength / RoomBins::kBin;
  score_maps(result.frozen, spacing, result.frozen_gridness, result.frozen_best);
  score_maps(result.live, spacing, result.live_gridness, result.live_best);
  result.alike_weights = alike_pairs(network.forward().transpose(), 0.95F, true);
  result.alike_maps = alike_pairs(known_rates(result.frozen), 0.8F, false);
  return result;
}

}  // namespace penumbra::slam::brain
