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
//   is
//     removed. L is the range over gamma, so that gross mismatches no longer decide how wide a bin is.
//   - a pair is kept if the density at its bin, averaged over the bin and its two neighbours, reaches a
//   fraction
//     a of the average density of the fullest bin. The motion of a camera spreads D over many bins.
// With N < 8 pairs nothing is removed: there is no distribution to speak of.
//
// Source: Jiang, Chen, Yuan (2022), doi 10.3788/LOP213265, section on the mismatch filter, equations
// (10)-(12). Cost: O(N); about 10 microseconds for 500 pairs.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string_view>
#include <vector>

namespace penumbra::slam {

enum class MismatchFilterMode { off, paper, adaptive };

// "off", "paper", "adaptive"; throws UsageError for another name.
MismatchFilterMode mismatch_filter_mode(std::string_view name);
std::string_view name_of(MismatchFilterMode mode);

struct MismatchFilterSettings {
  MismatchFilterMode mode = MismatchFilterMode::adaptive;
  double fence = 1.5;  // f: how many interquartile ranges beyond the quartiles still belong to the bulk
  double density_share = 0.02;  // a: rarest density that is kept, as a share of the highest
};

struct MatchedPixels {
  Eigen::Vector2f first, second;  // pixels in the one and the other image
};

struct MismatchFilterReport {
  struct Bin {
    double from = 0.0, to = 0.0;  // pixels
    int kept = 0, removed = 0;
  };
  std::vector<Bin> bins;      // (gamma + 1) bins
  int kept = 0, removed = 0;  // all pairs
  int outside = 0;            // removed pairs that are in no bin
};

// `keep` gets one entry per pair, 1 or 0. A pair whose distance is not finite is always removed.
MismatchFilterReport filter_mismatches(std::span<const MatchedPixels> pairs,
                                       const MismatchFilterSettings& settings, std::vector<char>& keep);

}  // namespace penumbra::slam
