// Checks of numbers on the command line. CLI11's own take "nan" for a number in any range.
#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

namespace penumbra::apps {

inline CLI::Validator finite_number(const std::string& what, bool (*fits)(double, double, double), double low,
                                    double high) {
  return CLI::Validator(
      [=](std::string& text) {
        double value = 0.0;
        const bool good =
            CLI::detail::lexical_cast(text, value) && std::isfinite(value) && fits(value, low, high);
        return good ? std::string() : "expected " + what + ", found " + text;
      },
      "");
}

// From `low` to `high`, both included; `what` says so, such as "a share from 0 to 1".
inline CLI::Validator number_from(double low, double high, const std::string& what) {
  return finite_number(
      what, [](double x, double a, double b) { return x >= a && x <= b; }, low, high);
}

inline CLI::Validator number_above_zero() {
  return finite_number(
      "a number above 0", [](double x, double, double) { return x > 0.0; }, 0.0, 0.0);
}

}  // namespace penumbra::apps
