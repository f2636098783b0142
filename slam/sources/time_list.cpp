#include "slam/sources/time_list.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

#include "nn/base/error.h"
#include "nn/base/number_file.h"
#include "nn/base/text.h"
#include "slam/geometry/time_unit.h"

namespace penumbra::slam {

bool is_heading(std::string_view line) {
  const std::string word = lower_case(line.substr(0, line.find_first_of(" \t,;")));
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  // A number that is none, and one with a letter by mistake (l403636), are to be refused.
  if (word.size() < 2 || word == "nan" || word == "inf" || word == "infinity") return false;
  return (is_letter(static_cast<unsigned char>(word.front())) || word.front() == '"') &&
         std::count_if(word.begin(), word.end(), is_digit) <
             std::count_if(word.begin(), word.end(), is_letter);
}

std::string heading_note(std::string_view place, std::string_view line) {
  return fmt::format("{}: '{}' is taken for a heading", place, printable(line, 60));
}

std::vector<double> read_time_list(const std::filesystem::path& path, std::vector<std::string>& notes) {
  std::vector<FileTime> times;
  std::vector<int> lines;
  nn::LineReader reader(path, "a text file with a time in each line");
  bool is_first = true;
  while (const std::optional<std::string_view> line = reader.next()) {
    if (std::exchange(is_first, false) && is_heading(*line)) {
      notes.push_back(heading_note(reader.place(), *line));
      continue;
    }
    times.push_back(parse_file_time(*line, reader.place()));
    lines.push_back(reader.line());
  }
  if (times.empty()) return {};
  std::vector<double> seconds = to_seconds(times, kCameraSeconds, path.string(), notes);
  for (std::size_t i = 1; i < seconds.size(); ++i) {
    if (seconds[i] < seconds[i - 1]) {
      throw InputError(fmt::format("{}:{}", path.string(), lines[i]),
                       fmt::format("a time after {:.6f} s", seconds[i - 1]),
                       fmt::format("{:.6f} s", seconds[i]));
    }
  }
  return seconds;
}

}  // namespace penumbra::slam
