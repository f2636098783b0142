#include "slam/geometry/pose_table.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/number_file.h"
#include "nn/base/text.h"
#include "slam/geometry/pose_columns.h"

namespace penumbra::slam {

namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";
constexpr std::size_t kLongestList = 8;  // names that a note repeats

std::string_view trim(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

bool is_comment(std::string_view line) {
  return line.front() == '#' || line.front() == '%' || line.substr(0, 2) == "//";
}

// A line of names, which may begin with one that is empty.
bool is_header(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of("\"', \t;"), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of("\"', \t;"));
  if (word.empty() || word == "nan" || word == "inf") return false;
  return std::isalpha(static_cast<unsigned char>(word.front())) != 0 || word.front() == '_' ||
         word.front() == '/';
}

// Whether each comma stands between digits and something else separates the numbers.
bool has_decimal_commas(std::string_view line) {
  if (line.find(',') == std::string_view::npos || line.find_first_of("; \t") == std::string_view::npos)
    return false;
  const auto is_digit = [&](std::size_t i) {
    return i < line.size() && std::isdigit(static_cast<unsigned char>(line[i])) != 0;
  };
  bool is_second = false;  // of one number
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == ';' || line[i] == ' ' || line[i] == '\t') is_second = false;
    if (line[i] != ',') continue;
    if (is_second || i == 0 || !is_digit(i - 1) || !is_digit(i + 1)) return false;
    is_second = true;
  }
  return true;
}

std::vector<std::string_view> split(std::string_view line) {
  const bool by_blanks = line.find_first_of(",;") == std::string_view::npos;
  const std::string_view separators = by_blanks                                  ? kBlanks
                                      : line.find(';') != std::string_view::npos ? std::string_view(";")
                                                                                 : std::string_view(",");
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    const std::string_view field = trim(line.substr(begin, end - begin));
    begin = end + 1;
    if (!field.empty() || !by_blanks) fields.push_back(field);
  }
  while (!fields.empty() && fields.back().empty()) fields.pop_back();
  return fields;
}

class PoseTableReader {
 public:
  explicit PoseTableReader(const std::filesystem::path& path) {
    table_.path = path.string();
    text_ = nn::read_text_file(path, "a text file with a pose in each line");
  }

  PoseTable read() {
    for (std::size_t start = 0; start < text_.size();) {
      const std::size_t end = std::min(text_.find('\n', start), text_.size());
      const std::string_view line = trim(std::string_view(text_).substr(start, end - start));
      start = end + 1;
      ++number_;
      if (line.empty()) continue;
      const bool comment = is_comment(line);
      if (comment || (table_.lines.empty() && is_header(line))) {
        if (table_.lines.empty() && !table_.is_named) add_header(line, comment);
      } else {
        add_pose(line);
      }
    }
    if (table_.lines.empty()) throw InputError(table_.path, "at least one pose", "none");
    add_notes();
    return std::move(table_);
  }

 private:
  std::string place() const { return fmt::format("{}:{}", table_.path, number_); }

  void add_header(std::string_view line, bool comment) {
    const std::vector<std::string> names = column_names(line);
    columns_ = find_pose_columns(names, comment, place());
    header_is_comment_ = comment;
    table_.is_named = columns_.has_value();
    if (columns_ || !table_.w_first) table_.w_first = is_w_first(names);
    if (!columns_ && !comment) unknown_names_ = {place(), names};
  }

  void add_pose(std::string_view text) {
    std::string line(text.substr(0, text.find('#')));
    line.erase(std::remove(line.begin(), line.end(), '"'), line.end());
    if (has_decimal_commas(line)) {
      std::replace(line.begin(), line.end(), ',', '.');
      decimal_commas_ = true;
    }
    table_.has_commas = table_.has_commas || line.find_first_of(",;") != std::string::npos;
    const std::vector<std::string_view> fields = split(line);
    if (table_.lines.empty()) begin(fields.size());
    PoseLine pose{number_, {}, {}};
    if (columns_) {
      read_named(fields, pose);
    } else {
      if (!fields.empty()) pose.first = parse_file_time(fields.front(), place());
      for (const std::string_view field : fields) pose.values.push_back(number(field));
    }
    table_.lines.push_back(std::move(pose));
  }

  // A comment whose names are not those of the columns is prose.
  void begin(std::size_t fields) {
    fields_ = fields;
    const bool may_be_matrix = fields == 12 || fields == 13 || fields == 16 || fields == 17;
    if (!columns_ && unknown_names_.names.size() == fields && !may_be_matrix) {
      throw InputError(unknown_names_.place, "names of columns that are known, such as t x y z qx qy qz qw",
                       printable(fmt::format("{}", fmt::join(unknown_names_.names, ", "))));
    }
    if (!columns_) return;
    const std::size_t names = columns_->names.size();
    if (header_is_comment_ && fields < columns_->end()) {
      columns_.reset();
      table_.is_named = false;
    } else if (fields < columns_->end() || (fields > names && !header_is_comment_)) {
      throw InputError(place(), counted(names, "field") + ", as the header has names",
                       fmt::format("{}", fields));
    }
  }

  void read_named(const std::vector<std::string_view>& fields, PoseLine& pose) {
    if (fields.size() != fields_) {
      throw InputError(place(), counted(fields_, "field") + " as in the first line",
                       fmt::format("{}", fields.size()));
    }
    if (columns_->time) {
      pose.first = parse_file_time(fields[*columns_->time], place());
      if (columns_->nanoseconds) add_nanoseconds(fields[*columns_->nanoseconds], pose.first);
      pose.values.push_back(pose.first.value);
    }
    for (const std::size_t i : columns_->position) pose.values.push_back(number(fields[i]));
    for (const std::size_t i : columns_->quaternion) pose.values.push_back(number(fields[i]));
  }

  void add_nanoseconds(std::string_view field, FileTime& time) const {
    constexpr std::int64_t kBillion = 1'000'000'000;
    const FileTime part = parse_file_time(field, place());
    const auto is_within = [](const FileTime& t, std::int64_t low, std::int64_t high) {
      return t.whole && *t.whole >= low && *t.whole < high;
    };
    const bool fits = is_within(time, -9 * kBillion, 9 * kBillion) && is_within(part, 0, kBillion);
    if (!fits) {
      throw InputError(place(), "whole seconds and 0 to 999999999 nanoseconds",
                       fmt::format("{:.10g} and {:.10g}", time.value, part.value));
    }
    const std::int64_t whole = *time.whole * kBillion + *part.whole;
    time = {static_cast<double>(whole), whole};
  }

  double number(std::string_view field) const {
    const std::vector<double> numbers = nn::parse_numbers(field, place());
    if (numbers.size() != 1)
      throw InputError(place(), "a number", numbers.empty() ? "an empty field" : "several in one field");
    return numbers.front();
  }

  void add_notes() {
    if (decimal_commas_)
      table_.notes.push_back(fmt::format("{}: the commas are taken as decimal commas", table_.path));
    if (!columns_) return;
    table_.unit = columns_->nanoseconds ? TimeUnit::nanoseconds : columns_->unit;
    if (columns_->time_is_index) {
      table_.notes.push_back(fmt::format("{}: no column of times; '{}' is taken", table_.path,
                                         columns_->names[*columns_->time]));
    }
    std::vector<std::string> names = columns_->left_out();
    const std::size_t unnamed = fields_ - std::min(fields_, columns_->names.size());
    const std::size_t count = names.size() + unnamed;
    if (count == 0) return;
    names.resize(std::min(names.size(), kLongestList));
    if (names.size() < count) names.push_back(fmt::format("{} more", count - names.size()));
    table_.notes.push_back(fmt::format("{}: columns that are no part of a pose are left out: {}", table_.path,
                                       fmt::join(names, ", ")));
  }

  PoseTable table_;
  std::string text_;
  int number_ = 0;          // of the line
  std::size_t fields_ = 0;  // of the first line
  std::optional<PoseColumns> columns_;
  bool header_is_comment_ = false, decimal_commas_ = false;
  struct {
    std::string place;
    std::vector<std::string> names;
  } unknown_names_;  // of a header that is no comment
};

}  // namespace

std::string PoseTable::place(const PoseLine& line) const { return fmt::format("{}:{}", path, line.line); }

PoseTable read_pose_table(const std::filesystem::path& path) { return PoseTableReader(path).read(); }

}  // namespace penumbra::slam
