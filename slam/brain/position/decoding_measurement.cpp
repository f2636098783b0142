#include "slam/brain/position/decoding_measurement.h"

#include <cmath>

#include "nn/base/quantile.h"
#include "slam/brain/position/place_cells.h"
#include "slam/brain/position/random_stream.h"

namespace penumbra::slam::brain {

namespace {

Eigen::Vector2d somewhere(RandomStream& random, double side) {
  const double x = random.uniform(-0.5 * side, 0.5 * side);
  return {x, random.uniform(-0.5 * side, 0.5 * side)};
}

}  // namespace

std::vector<DecodingError> measure_decoding(const GridCode& code, std::span<const double> noises,
                                            const DecodingSettings& settings) {
  const PlaceCells cells =
      PlaceCells::on_square(code, Eigen::Vector2d::Zero(), 0.5 * settings.side, settings.step);
  GridCodeReader reader(code);
  std::vector<float> noisy(static_cast<std::size_t>(code.cells()));
  std::vector<DecodingError> results;
  for (const double noise : noises) {
    RandomStream random(settings.seed, 7);  // the same places for every noise
    std::vector<double> errors;
    for (int trial = 0; trial < settings.trials; ++trial) {
      const Eigen::Vector2d place = somewhere(random, settings.side);
      const std::span<const float> grid = reader.at(place);
      for (std::size_t i = 0; i < noisy.size(); ++i) {
        noisy[i] = grid[i] + static_cast<float>(noise * random.normal());
      }
      errors.push_back((cells.winner(noisy).place - place).norm() / settings.side);
    }
    results.push_back({quantile_of(errors, 0.5), quantile_of(errors, 0.95)});
  }
  return results;
}

double activity_deviation(const GridCode& code, const DecodingSettings& settings) {
  GridCodeReader reader(code);
  RandomStream random(settings.seed, 8);
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < settings.trials; ++i) {
    for (const float cell : reader.at(somewhere(random, settings.side))) {
      sum += cell;
      squares += static_cast<double>(cell) * cell;
    }
  }
  const double n = static_cast<double>(settings.trials) * code.cells();
  return std::sqrt(squares / n - sum * sum / (n * n));
}

GridCode as_long_as(const GridCode& code, const GridCode& like) {
  GridCode stretched = code;
  for (std::size_t m = 0; m < stretched.modules.size(); ++m) {
    Eigen::MatrixXf& weights = stretched.modules[m].weights;
    weights *= like.modules[m].weights.norm() / weights.norm();
  }
  return stretched;
}

}  // namespace penumbra::slam::brain
