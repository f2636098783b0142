#include "nn/base/number_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/text.h"

namespace penumbra::nn {

namespace {

constexpr std::string_view kBlank = " \t\r\v\f";
constexpr std::size_t kLongestQuote = 40;  // bytes of a bad word that a message repeats

double parse_number(std::string_view word, std::string_view place) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  // from_chars refuses what underflows; strtod rounds it to (nearly) zero, as every other reader does.
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(digits).c_str(), nullptr);
  const bool is_number = error != std::errc::invalid_argument && end == digits.data() + digits.size();
  if (!is_number || !std::isfinite(value)) {
    throw InputError(place, is_number ? "a finite number" : "a number",
                     fmt::format("'{}'", printable(word, kLongestQuote)));
  }
  return value;
}

}  // namespace

std::vector<double> parse_numbers(std::string_view text, std::string_view place) {
  std::vector<double> values;
  while (true) {
    const std::size_t start = text.find_first_not_of(kBlank);
    if (start == std::string_view::npos) return values;
    text.remove_prefix(start);
    const std::size_t length = std::min(text.find_first_of(kBlank), text.size());
    values.push_back(parse_number(text.substr(0, length), place));
    text.remove_prefix(length);
  }
}

LineReader::LineReader(const std::filesystem::path& path, std::string_view expected)
    : path_(path.string()), text_(read_text_file(path, expected)) {}

std::optional<std::string_view> LineReader::next() {
  while (start_ < text_.size()) {
    const std::size_t end = std::min(text_.find('\n', start_), text_.size());
    const std::string_view content = std::string_view(text_).substr(start_, end - start_);
    start_ = end + 1;
    ++line_;
    const std::size_t first = content.find_first_not_of(kBlank);
    if (first == std::string_view::npos || content[first] == '#') continue;
    return content.substr(first, content.find_last_not_of(kBlank) - first + 1);
  }
  return std::nullopt;
}

std::string LineReader::place() const { return fmt::format("{}:{}", path_, line_); }

NumberFileReader::NumberFileReader(const std::filesystem::path& path, std::string_view record)
    : lines_(path, fmt::format("a text file with {} in each line", record)) {}

std::optional<NumberLine> NumberFileReader::next() {
  const std::optional<std::string_view> line = lines_.next();
  if (!line) return std::nullopt;
  return NumberLine{lines_.line(), parse_numbers(*line, place())};
}

std::vector<NumberLine> read_number_file(const std::filesystem::path& path, int columns,
                                         std::string_view record) {
  NumberFileReader reader(path, record);
  std::vector<NumberLine> lines;
  while (std::optional<NumberLine> numbers = reader.next()) {
    if (numbers->values.size() != static_cast<std::size_t>(columns)) {
      throw InputError(reader.place(), fmt::format("{} ({})", record, counted(columns, "number")),
                       counted(numbers->values.size(), "number"));
    }
    lines.push_back(std::move(*numbers));
  }
  return lines;
}

}  // namespace penumbra::nn
