// Lets the poses of a cognitive map settle between what its links have measured.
//
// The paper moves every node by
//
//   Delta p_i = rho [ sum_j (p_j - p_i - L_ij) + sum_k (p_k - p_i - L_ki) ],   rho = 0.6       (21, 22)
//
// over its links j forward and k backward, again and again until nothing moves. In the letter two things
// fail. For a node of d links the step is rho d of the way to where its links want it: beyond twice that way,
// with d > 3, such neighbours throw each other ever farther and the map flies apart (moved all at once, and
// not one after the other as here, it does so already with d = 2). And L is a motion in the plane, so that
// what a node's own heading got wrong stays: after a turn that was felt wrong no place fits. So there are
//
//   paper     (21, 22) as printed, headings left alone; sweeps until the largest move is below `settled`
//             metres, or `sweeps`; a map that flies apart is given back as it was
//   mean      rho times the mean over a node's links in place of the sum, headings relaxed the same way:
//             stable for any number of links, but a chain of n nodes needs about n^2 sweeps
//   settled   what sweeps of that kind lead to, at once (default): Gauss-Newton on the sum of
//             |R_i^T (p_j - p_i) - d_ij|^2 / s_d^2 + (theta_j - theta_i - delta_ij)^2 / s_theta^2,
//             sparse Cholesky, begun at the headings that the links' turns alone agree on
//
// The first node stays. Cost of `settled`: about 3 ms for 1500 nodes with 2000 links.
// Source: docs/papers.md (21, 22); Duckett, Marsland, Shapiro, Learning globally consistent maps by
// relaxation (ICRA 2000); Carlone et al., A fast and accurate approximation for planar pose graph
// optimization (IJRR 2014), for the start.
#pragma once

#include <string_view>

#include "slam/brain/map/cognitive_map.h"

namespace penumbra::slam::brain {

enum class RelaxationMode { paper, mean, settled };
// "paper", "mean" or "settled"; throws UsageError for another name.
RelaxationMode relaxation_mode(std::string_view name);

struct RelaxationSettings {
  RelaxationMode mode = RelaxationMode::settled;
  double rho = 0.6;
  int sweeps = 1000;      // at most, of the first two
  double settled = 1e-4;  // metres
  int iterations = 5;     // of the third
};

struct RelaxationSummary {
  int sweeps = 0;
  double largest_move = 0.0;  // metres, from before the first to after the last
  bool settled = false;
  bool flew_apart = false;  // and the map was left as it was
};

// Moves the map's nodes. A map of which a pose would not be finite is left as it was, with `settled` false.
RelaxationSummary relax(CognitiveMap& map, const RelaxationSettings& settings = {});

// Root mean square of what the links disagree by, metres; 0 without links.
double disagreement(const CognitiveMap& map);

}  // namespace penumbra::slam::brain
