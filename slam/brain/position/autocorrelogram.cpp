#include "slam/brain/position/autocorrelogram.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace penumbra::slam::brain {

namespace {

constexpr int kMargin = 7;        // bins that overlap at least, in both directions
constexpr float kFewest = 30.0F;  // pairs
constexpr double kFlat = 1e-5;    // share of the mean square below which a variance is rounding

// The map, its squares and its mask, which all are 0 where it is not known; a row of the map a column.
struct Summands {
  Eigen::ArrayXXf rate, square, known;

  explicit Summands(const RateMap& map)
      : rate(Eigen::Map<const Eigen::ArrayXXf>(map.rate.data(), map.size, map.size)),
        known(Eigen::Map<const Eigen::Array<char, Eigen::Dynamic, Eigen::Dynamic>>(map.known.data(), map.size,
                                                                                   map.size)
                  .cast<float>()) {
    rate *= known;
    square = rate.square();
  }
};

float correlation_at(const Summands& map, int size, int dx, int dy) {
  const int columns = size - std::abs(dx);
  float n = 0, a = 0, b = 0, ab = 0, aa = 0, bb = 0;
  for (int row = std::max(0, -dy); row < std::min(size, size - dy); ++row) {
    const auto here = [&](const Eigen::ArrayXXf& of) {
      return of.col(row).segment(std::max(0, -dx), columns);
    };
    const auto there = [&](const Eigen::ArrayXXf& of) {
      return of.col(row + dy).segment(std::max(0, dx), columns);
    };
    n += (here(map.known) * there(map.known)).sum();
    a += (here(map.rate) * there(map.known)).sum();
    b += (here(map.known) * there(map.rate)).sum();
    ab += (here(map.rate) * there(map.rate)).sum();
    aa += (here(map.square) * there(map.known)).sum();
    bb += (here(map.known) * there(map.square)).sum();
  }
  if (n <= kFewest) return 0.0F;
  const double first = double(n) * aa - double(a) * a, second = double(n) * bb - double(b) * b;
  if (first <= kFlat * n * aa || second <= kFlat * n * bb) return 0.0F;
  const double correlation = (double(n) * ab - double(a) * b) / std::sqrt(first * second);
  return std::clamp(static_cast<float>(correlation), -1.0F, 1.0F);
}

}  // namespace

Autocorrelogram autocorrelogram(const RateMap& map) {
  Autocorrelogram result;
  result.radius = map.size - kMargin;
  const int side = 2 * result.radius + 1;
  result.values.resize(static_cast<std::size_t>(side * side));
  const Summands summands(map);
  for (int dy = 0; dy <= result.radius; ++dy) {
    for (int dx = dy == 0 ? 0 : -result.radius; dx <= result.radius; ++dx) {
      const float value = correlation_at(summands, map.size, dx, dy);
      const int place = (dy + result.radius) * side + dx + result.radius;
      result.values[static_cast<std::size_t>(place)] = value;
      result.values[static_cast<std::size_t>(side * side - 1 - place)] = value;  // of (-dx, -dy): the same
    }
  }
  return result;
}

}  // namespace penumbra::slam::brain
