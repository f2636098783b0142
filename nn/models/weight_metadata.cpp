#include "nn/models/weight_metadata.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>

#include "nn/base/error.h"
#include "nn/base/text.h"

namespace penumbra::nn {

namespace {

// The whole of `text` as a number in `range`.
std::optional<double> parse_number(std::string_view text, const NumberRange& range) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!(value >= range.least && value <= range.most)) return std::nullopt;  // a NaN, too
  return value;
}

[[noreturn]] void fail(const StateDict& weights, const std::string& key, const std::string& expected,
                       const std::string& found) {
  throw InputError(weights.source + ", metadata " + key, expected, "'" + printable(found) + "'");
}

std::string describe(const NumberRange& range) { return fmt::format("{}..{}", range.least, range.most); }

}  // namespace

std::optional<double> metadata_number(const StateDict& weights, const std::string& key,
                                      const NumberRange& range) {
  const auto found = weights.metadata.find(key);
  if (found == weights.metadata.end()) return std::nullopt;
  const std::optional<double> value = parse_number(found->second, range);
  if (!value) fail(weights, key, "a number in " + describe(range), found->second);
  return value;
}

std::optional<int> metadata_integer(const StateDict& weights, const std::string& key,
                                    const NumberRange& range) {
  const std::optional<double> value = metadata_number(weights, key, range);
  if (!value) return std::nullopt;
  if (*value != std::floor(*value)) {
    fail(weights, key, "a whole number in " + describe(range), weights.metadata.at(key));
  }
  return static_cast<int>(*value);
}

std::vector<double> metadata_numbers(const StateDict& weights, const std::string& key, std::size_t count,
                                     const NumberRange& range) {
  const auto found = weights.metadata.find(key);
  if (found == weights.metadata.end()) return {};
  std::vector<double> numbers;
  std::string_view rest = found->second;
  while (true) {
    const std::size_t comma = rest.find(',');
    const std::optional<double> value = parse_number(rest.substr(0, comma), range);
    if (value) numbers.push_back(*value);
    const bool last = comma == std::string_view::npos;
    if (!value || numbers.size() > count || (last && numbers.size() < count)) {
      fail(weights, key, fmt::format("{} numbers in {}, separated by commas", count, describe(range)),
           found->second);
    }
    if (last) return numbers;
    rest.remove_prefix(comma + 1);
  }
}

}  // namespace penumbra::nn
