#include "slam/brain/position/rate_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "slam/brain/position/random_stream.h"

namespace penumbra::slam::brain {

namespace {

constexpr int kRunUp = 8, kHeadings = 4;

// Convolves with a Gaussian of 1 bin, cut off at 4; what lies outside counts 0.
std::vector<float> smoothed_bins(const std::vector<float>& values, int size) {
  constexpr int kReach = 4;
  std::array<float, 2 * kReach + 1> kernel{};
  for (int i = -kReach; i <= kReach; ++i) {
    kernel[static_cast<std::size_t>(i + kReach)] = std::exp(-0.5F * static_cast<float>(i * i));
  }
  const auto pass = [&](const std::vector<float>& from, int along, int across) {
    std::vector<float> to(from.size());
    for (int line = 0; line < size; ++line) {
      for (int i = 0; i < size; ++i) {
        float sum = 0.0F;
        for (int k = std::max(-kReach, -i); k <= std::min(kReach, size - 1 - i); ++k) {
          sum += kernel[static_cast<std::size_t>(k + kReach)] *
                 from[static_cast<std::size_t>(line * across + (i + k) * along)];
        }
        to[static_cast<std::size_t>(line * across + i * along)] = sum;
      }
    }
    return to;
  };
  return pass(pass(values, 1, size), size, 1);
}

// The frozen network's activity at a position, reached along a heading.
void read_frozen(Lahn& network, Oscillators& oscillators, const FrozenReading& reading, int steps,
                 const Eigen::Vector2d& position, double heading, std::span<float> chi) {
  network.forget_activity();
  const Eigen::Vector2d way =
      reading.walk.speed * reading.walk.step * Eigen::Vector2d(std::cos(heading), std::sin(heading));
  for (int i = steps - 1; i >= 0; --i) {
    const Eigen::Vector2d at = position - i * way;
    oscillators.place(at);
    oscillators.output(chi);
    if (reading.boundary_factor) {
      apply_boundary_factor(boundary_factor(reading.room->wall_ahead(at, heading)), chi);
    }
    network.step(chi);
  }
}

}  // namespace

RoomBins::RoomBins(const Room& room) {
  for (const Eigen::Vector2d& corner : room.corners()) {
    extent = std::max(extent, corner.cwiseAbs().maxCoeff());
  }
  size = static_cast<int>(std::ceil(2.0 * extent / kBin - 1e-9));
}

Eigen::Vector2d RoomBins::centre(int column, int row) const {
  return {(column + 0.5) * kBin - extent, (row + 0.5) * kBin - extent};
}

std::size_t RoomBins::bin_of(const Eigen::Vector2d& position) const {
  const auto place = [&](double x) { return std::clamp(static_cast<int>((x + extent) / kBin), 0, size - 1); };
  return static_cast<std::size_t>(place(position.y()) * size + place(position.x()));
}

std::vector<RateMap> frozen_rate_maps(const Lahn& network, const Oscillators& oscillators,
                                      const FrozenReading& reading) {
  Lahn read = network.reader();
  Oscillators placed = oscillators;
  RandomStream random(reading.seed, 6);
  const RoomBins bins(*reading.room);
  const auto area = static_cast<std::size_t>(bins.size * bins.size);
  RateMap empty{bins.size, std::vector<float>(area), std::vector<char>(area)};
  std::vector<RateMap> maps(read.activity().size(), empty);
  std::vector<float> chi(static_cast<std::size_t>(placed.outputs()));
  const bool run_up = read.settings().lateral != LateralRule::none;
  const int headings = run_up || reading.boundary_factor ? kHeadings : 1;
  for (std::size_t bin = 0; bin < area; ++bin) {
    const Eigen::Vector2d at =
        bins.centre(static_cast<int>(bin) % bins.size, static_cast<int>(bin) / bins.size);
    if (!reading.room->contains(at)) continue;
    for (int i = 0; i < headings; ++i) {
      const double heading = random.uniform(-std::numbers::pi, std::numbers::pi);
      read_frozen(read, placed, reading, run_up ? kRunUp : 1, at, heading, chi);
      for (std::size_t cell = 0; cell < maps.size(); ++cell) {
        maps[cell].rate[bin] += std::max(read.activity()[cell], 0.0F) / static_cast<float>(headings);
      }
    }
    for (RateMap& map : maps) map.known[bin] = 1;
  }
  return maps;
}

LiveRateMaps::LiveRateMaps(const Room& room, int cells)
    : bins_(room),
      cells_(static_cast<std::size_t>(cells)),
      sums_(static_cast<std::size_t>(bins_.size * bins_.size) * cells_),
      visits_(static_cast<std::size_t>(bins_.size * bins_.size)) {}

void LiveRateMaps::add(const Eigen::Vector2d& position, std::span<const float> activity) {
  const std::size_t bin = bins_.bin_of(position);
  for (std::size_t cell = 0; cell < cells_; ++cell)
    sums_[bin * cells_ + cell] += std::max(activity[cell], 0.0F);
  visits_[bin] += 1.0F;
}

RateMap LiveRateMaps::map(int cell) const {
  RateMap map{bins_.size, std::vector<float>(visits_.size()), std::vector<char>(visits_.size())};
  std::vector<float> sums(visits_.size());
  for (std::size_t bin = 0; bin < sums.size(); ++bin) {
    sums[bin] = sums_[bin * cells_ + static_cast<std::size_t>(cell)];
  }
  const std::vector<float> activity = smoothed_bins(sums, bins_.size);
  const std::vector<float> visits = smoothed_bins(visits_, bins_.size);
  for (std::size_t bin = 0; bin < sums.size(); ++bin) {
    if (visits_[bin] == 0.0F) continue;
    map.known[bin] = 1;
    map.rate[bin] = activity[bin] / visits[bin];
  }
  return map;
}

}  // namespace penumbra::slam::brain
