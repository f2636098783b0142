#include "slam/brain/position/position_model.h"

#include "slam/brain/position/grid_training.h"

namespace penumbra::slam::brain {

PositionModel::PositionModel(const GridCode& code, const PositionModelSettings& settings)
    : ring_(code.directions),
      reader_(code.at_scales(settings.first_wavelength, settings.wavelength_ratio)),
      elsewhere_(reader_.code()),
      oscillators_(reader_.code().oscillators()) {
  reset(Eigen::Vector2d::Zero(), 0.0);
}

void PositionModel::move(double speed, double turn_rate, double seconds) {
  ring_.turn(turn_rate, 0.5 * seconds);
  for (Oscillators& module : oscillators_) module.advance(ring_, speed, seconds);
  ring_.turn(turn_rate, 0.5 * seconds);
  reader_.at(oscillators_);
}

void PositionModel::reset(const Eigen::Vector2d& position, double heading) {
  ring_.set_heading(heading);
  for (Oscillators& module : oscillators_) module.place(position);
  reader_.at(oscillators_);
}

std::span<const float> PositionModel::activity_at(const Eigen::Vector2d& position) {
  return elsewhere_.at(position);
}

const GridCode& standard_grid_code() {
  static const GridCode code = [] {
    GridTrainingSettings settings;
    settings.modules = 10;
    return train_grid_code(settings);
  }();
  return code;
}

}  // namespace penumbra::slam::brain
