// Grid cells: a lateral anti-Hebbian network (LAHN) over the outputs chi of the oscillators.
//
//   xi_i(t)  = f( sum_j q_ij chi_j(t) + sum_k w_ik xi_k(t-1) )             (5)
//   dq_ij    = eta_F ( chi_j xi_i - q_ij xi_i^2 )                          (6)   Oja's rule
//   dw_ik    = -eta_L xi_i(t) xi_k(t-1)                                    (7)
//   q, w    <- q / max(1, m), w / max(1, m)   m = largest |q_ij| or |w_ik|: all weights together
//
//   paper      f = tanh, eta_F = eta_L = 0.9. Learns nothing: after a step at this rate the weights are the
//              present input, so all cells are one cell up to sign.
//   rectified  f(a) = min(max(a - 0.2, 0), 1), eta_F = 0.0017, in place of (7)
//                dw_ik = -eta_L (xi_i(t) xi_k(t-1) - p^2),   w_ik <= 0,   w_ii = 0,   eta_L = 0.0005, p = 0.1
//              An odd f has no term in which three waves help each other; a threshold has, and three waves at
//              60 degrees win. Cells that are active together more often than p^2 inhibit each other, so
//              their lattices part. The lateral weights serve learning alone: what has learned is read
//              without them (reader()), so that a place has one activity, whatever the way there.
//
// Rescaling is no safety net: numbers that are not finite pass it, so finite() has to be asked.
//
// Cost: 4 cells x inputs operations a step that learns: 0.7 us for 25 cells and 24 inputs.
// Source: Chen et al. (docs/papers.md, D.1); Foeldiak, Forming sparse representations by local anti-Hebbian
// learning (1990); Oja, A simplified neuron model as a principal component analyzer (1982).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string_view>

namespace penumbra::slam::brain {

// none: no lateral weights; paper: (7); foeldiak: as in "rectified" above.
enum class LateralRule { none, paper, foeldiak };

struct LahnSettings {
  int cells = 25;
  bool bipolar = false;  // f: tanh, else the threshold
  float threshold = 0.2F;
  float forward_rate = 0.0017F, lateral_rate = 0.0005F;  // eta_F and eta_L a step
  LateralRule lateral = LateralRule::foeldiak;
  float sparseness = 0.1F;    // p
  float first_weight = 0.1F;  // q begins uniform in [-first_weight, first_weight]
  float bound = 1.0F;         // of all weights

  // The rules by name: "rectified" and "paper"; UsageError for another.
  static LahnSettings of_rule(std::string_view name);
};

class Lahn {
 public:
  Lahn(int inputs, const LahnSettings& settings, std::uint64_t seed);
  Lahn(const Eigen::MatrixXf& forward, const LahnSettings& settings);

  // One step (5); with learn(), the rest of it.
  void step(std::span<const float> chi);
  void learn(std::span<const float> chi);
  void forget_activity();  // xi(t-1) = 0

  // The network as it is read when it has learned: `foeldiak` without lateral weights.
  Lahn reader() const;
  bool finite() const { return forward_.allFinite() && lateral_.allFinite(); }
  std::span<const float> activity() const { return {activity_.data(), std::size_t(activity_.size())}; }
  const Eigen::MatrixXf& forward() const { return forward_; }  // q, a row a cell
  const Eigen::MatrixXf& lateral() const { return lateral_; }  // w
  const LahnSettings& settings() const { return settings_; }

 private:
  void learn_lateral();

  LahnSettings settings_;
  Eigen::MatrixXf forward_, lateral_, change_;
  Eigen::VectorXf activity_, before_, drive_;
};

// f, for one cell.
float grid_cell_output(float drive, const LahnSettings& settings);

}  // namespace penumbra::slam::brain
