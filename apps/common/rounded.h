// Numbers of reports need no more digits than what was measured has.
#pragma once

#include <cmath>

namespace penumbra::apps {

inline double to_a_thousandth(double value) { return std::round(value * 1e3) / 1e3; }
inline double to_a_millionth(double value) { return std::round(value * 1e6) / 1e6; }

}  // namespace penumbra::apps
