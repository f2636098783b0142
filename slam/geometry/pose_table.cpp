#include "slam/geometry/pose_table.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "nn/base/error.h"
#include "nn/io/file.h"
#include "nn/io/number_file.h"

namespace penumbra::slam {

namespace {

constexpr std::string_view kSeparators = " \t,;";

// The words between separators; of "q_RS_w []" the unit is left out.
std::vector<std::string> column_names(std::string_view header) {
  std::vector<std::string> names;
  while (true) {
    const std::size_t begin = header.find_first_not_of("# \t,;");
    if (begin == std::string_view::npos) return names;
    header.remove_prefix(begin);
    const std::size_t end = std::min(header.find_first_of(kSeparators), header.size());
    std::string name(header.substr(0, end));
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    if (name.front() != '[') names.push_back(std::move(name));
    header.remove_prefix(end);
  }
}

std::optional<bool> is_w_first(std::string_view header) {
  const std::vector<std::string> names = column_names(header);
  const auto place = [&](char axis) {
    return std::find_if(names.begin(), names.end(), [&](const std::string& name) {
      return name.size() > 1 && name.find('q') != std::string::npos && name.back() == axis;
    });
  };
  const auto w = place('w'), x = place('x');
  if (w == names.end() || x == names.end()) return std::nullopt;
  return w < x;
}

std::string_view first_word(std::string_view line) {
  return line.substr(0, std::min(line.find_first_of(kSeparators), line.size()));
}

}  // namespace

std::string PoseTable::place(const PoseLine& line) const { return fmt::format("{}:{}", path, line.line); }

PoseTable read_pose_table(const std::filesystem::path& path) {
  PoseTable table;
  table.path = path.string();
  std::string text = nn::read_text_file(path, "a text file with a pose in each line");
  int number = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::size_t first = std::min(text.find_first_not_of(" \t\v\f", start), end);
    std::string_view line = std::string_view(text).substr(first, end - first);
    start = end + 1;
    ++number;
    if (line.empty()) continue;
    const std::string_view word = first_word(line);
    const bool is_header = table.lines.empty() &&
                           std::isalpha(static_cast<unsigned char>(line.front())) != 0 && word != "nan" &&
                           word != "inf";
    if (line.front() == '#' || is_header) {
      if (!table.w_first && table.lines.empty()) table.w_first = is_w_first(line);
      continue;
    }
    PoseLine pose{number, {}, {}};
    const std::string place = fmt::format("{}:{}", table.path, number);
    const auto is_comma = [](char c) { return c == ',' || c == ';'; };
    table.has_commas = table.has_commas || std::any_of(line.begin(), line.end(), is_comma);
    pose.first = parse_file_time(word, place);
    std::string blanks(line);
    std::replace_if(blanks.begin(), blanks.end(), is_comma, ' ');
    pose.values = nn::parse_numbers(blanks, place);
    table.lines.push_back(std::move(pose));
  }
  if (table.lines.empty()) throw InputError(table.path, "at least one pose", "none");
  return table;
}

}  // namespace penumbra::slam
