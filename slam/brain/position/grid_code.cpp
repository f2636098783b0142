#include "slam/brain/position/grid_code.h"

#include <utility>

namespace penumbra::slam::brain {

int GridCode::cells() const {
  int cells = 0;
  for (const GridModule& module : modules) cells += static_cast<int>(module.weights.rows());
  return cells;
}

GridCode GridCode::at_scales(double first, double ratio) const {
  GridCode code = *this;
  double wavelength = first;
  for (GridModule& module : code.modules) {
    module.wavelength = wavelength;
    wavelength *= ratio;
  }
  return code;
}

std::vector<Oscillators> GridCode::oscillators() const {
  std::vector<Oscillators> all;
  for (const GridModule& module : modules) all.emplace_back(directions, module.start, module.wavelength);
  return all;
}

GridCodeReader::GridCodeReader(GridCode code)
    : code_(std::move(code)),
      oscillators_(code_.oscillators()),
      chi_(2 * static_cast<std::size_t>(code_.directions.cols())),
      activity_(static_cast<std::size_t>(code_.cells())) {}

std::span<const float> GridCodeReader::at(std::span<const Oscillators> oscillators) {
  const Eigen::Map<const Eigen::VectorXf> input(chi_.data(), static_cast<Eigen::Index>(chi_.size()));
  std::size_t first = 0;
  for (std::size_t m = 0; m < code_.modules.size(); ++m) {
    const Eigen::MatrixXf& weights = code_.modules[m].weights;
    oscillators[m].output(chi_);
    Eigen::Map<Eigen::VectorXf> cells(activity_.data() + first, weights.rows());
    cells.noalias() = weights * input;
    for (float& cell : cells) cell = grid_cell_output(cell, code_.rule);
    first += static_cast<std::size_t>(weights.rows());
  }
  return activity_;
}

std::span<const float> GridCodeReader::at(const Eigen::Vector2d& position) {
  for (Oscillators& module : oscillators_) module.place(position);
  return at(oscillators_);
}

}  // namespace penumbra::slam::brain
