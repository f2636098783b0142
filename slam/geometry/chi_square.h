// The gates beyond which an error is taken for a mistake: 95 % quantiles of the chi-square distribution, of
// squared errors over their variance, by degrees of freedom; and the 99 % ones, where a mistake must be
// plain.
#pragma once

namespace penumbra::slam {

inline constexpr double kChiSquare1 = 3.84, kChiSquare2 = 5.991, kChiSquare3 = 7.815;
inline constexpr double kPlainChiSquare1 = 6.635, kPlainChiSquare2 = 9.210;

}  // namespace penumbra::slam
