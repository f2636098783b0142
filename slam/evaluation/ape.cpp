#include "slam/evaluation/ape.h"

#include "slam/evaluation/alignment.h"

namespace penumbra::slam {

std::vector<double> absolute_pose_errors(const Trajectory& reference, const Trajectory& estimate) {
  require_paired(reference, estimate, 1);
  std::vector<double> errors;
  errors.reserve(reference.size());
  for (std::size_t i = 0; i < reference.size(); ++i) {
    errors.push_back((estimate[i].T_wc.translation - reference[i].T_wc.translation).norm());
  }
  return errors;
}

}  // namespace penumbra::slam
