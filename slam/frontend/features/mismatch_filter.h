// Removes mismatches by the histogram of how far the features moved between two images.
//
// For N matched pairs (X_i, X'_i), pixels:
//   D_i = |X_i - X'_i|
//   gamma = ceil(sqrt(N))                                                              (10)
//   L = (D_max - D_min) / gamma                                                        (11)
//   bins [0, L), [L, 2L), ..., [gamma L, (gamma + 1) L];  y_k pairs in bin k;  p_k = y_k / N    (12)
//
// Mode `paper`: P_c = max_k p_k, and pairs in bins with p_k < P_c are removed: to the letter, only the
// fullest bin (and those that tie with it) survives. The bins start at 0 while the range starts at D_min:
// distances from (gamma + 1) L on, which exist when D_min > L, lie in no bin and are removed. That works
// while gross mismatches stretch D_max, so that L is wide; on clean matches it throws away most good pairs.
//
// Mode `adaptive` (ours) keeps the idea, a mismatch moved a distance that is rare, and drops the two
// weaknesses:
//   - the range is that of the bulk: [D_q1 - f IQR, D_q3 + f IQR] with the quartiles q1, q3; what is outside
//     is removed. L is the range over gamma, so that gross mismatches no longer decide how wide a bin is.
//   - a pair is kept if the density at its bin, averaged over the bin and its two neighbours, reaches a
//     fraction a of the average density of the fullest bin. The motion of a camera spreads D over many bins.
// With N < 8 pairs nothing is removed: there is no distribution to speak of.
//
// Mode `compensated` (ours) votes, by the adaptive rule, on what is left of the motion when that which is
// expected is taken away:
//   R_i = |X'_i - E_i|,   E_i = pi(T_21 P_i)
// with the point P_i (metres) that the feature X_i shows by its stereo depth or the map, the motion T_21 that
// is predicted, and the camera's projection pi. D_i falls with depth and grows towards the image's edge, so
// near features are rare and what moves along, such as a lorry ahead, wins the vote; R_i of the street is
// the noise of a pixel or two at every depth. (Metres, D_i Z_i / f, would not do: driving forwards they
// still grow towards the edge, and a turn of the camera grows with Z_i.) R_i has no sign but what it measures
// has one, so that its quartiles are -/+ the median of R_i and the range is [0, (1 + 2 f) median]: what is
// where it was expected is never outside, whatever the bulk does.
// Pairs without E_i, for want of depth or of a prediction, are judged by D_i in the adaptive vote of all
// pairs.
//
// Source: Jiang, Chen, Yuan (2022), doi 10.3788/LOP213265, section on the mismatch filter, equations
// (10)-(12). Cost: O(N); about 10 microseconds for 500 pairs, twice that for `compensated` with the E_i.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace penumbra::slam {

enum class MismatchFilterMode { off, paper, adaptive, compensated };

// By these names; throws UsageError for another name.
MismatchFilterMode mismatch_filter_mode(std::string_view name);
std::string_view name_of(MismatchFilterMode mode);

struct MismatchFilterSettings {
  MismatchFilterMode mode = MismatchFilterMode::adaptive;
  double fence = 1.5;  // f: how many interquartile ranges beyond the quartiles still belong to the bulk
  double density_share = 0.02;  // a: rarest density that is kept, as a share of the highest
};

struct MatchedPixels {
  Eigen::Vector2f first, second;  // pixels in the one and the other image
  // E: where the second is expected. Only `compensated` reads it; one that is not finite counts as none.
  std::optional<Eigen::Vector2f> expected{};
};

struct MismatchFilterReport {
  struct Bin {
    double from = 0.0, to = 0.0;  // pixels of D_i, or of R_i
    int kept = 0, removed = 0;
  };
  std::vector<Bin> bins;      // (gamma + 1) bins; `compensated`: of the pairs with E_i, if there are any
  int kept = 0, removed = 0;  // all pairs
  int outside = 0;            // pairs that are in no bin
};

// `keep` gets one entry per pair, 1 or 0. A pair whose distance is not finite is always removed.
MismatchFilterReport filter_mismatches(std::span<const MatchedPixels> pairs,
                                       const MismatchFilterSettings& settings, std::vector<char>& keep);

}  // namespace penumbra::slam
