// The gates beyond which an error is taken for a mistake: 95 % quantiles of the chi-square distribution, of
// squared errors over their variance, by degrees of freedom.
#pragma once

namespace penumbra::slam {

inline constexpr double kChiSquare1 = 3.84, kChiSquare2 = 5.991, kChiSquare3 = 7.815;

}  // namespace penumbra::slam
