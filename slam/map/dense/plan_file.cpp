#include "slam/map/dense/plan_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/number_file.h"
#include "nn/base/text.h"

namespace penumbra::slam {

namespace {

// A file's lines "key: value", by key.
class KeyedLines {
 public:
  struct Value {
    std::string text;   // without quotes, blanks and comments around it
    std::string place;  // "file:line"
  };

  explicit KeyedLines(const std::filesystem::path& path) : path_(path.string()) {
    nn::LineReader lines(path, "a map_server's YAML file");
    while (const std::optional<std::string_view> line = lines.next()) {
      const std::size_t colon = line->find(':');
      if (colon == std::string_view::npos) continue;
      const std::string_view text = line->substr(colon + 1, line->find(" #", colon + 1) - colon - 1);
      const std::string_view around = " \t\r\"'";
      const std::size_t first = std::min(text.find_first_not_of(around), text.size());
      const std::string_view value = text.substr(first, text.find_last_not_of(around) + 1 - first);
      values_.try_emplace(std::string(line->substr(0, colon)), Value{std::string(value), lines.place()});
    }
  }

  const Value& at(const std::string& key) const {
    const auto found = values_.find(key);
    if (found != values_.end()) return found->second;
    throw InputError(path_, fmt::format("a line '{}: ...' as map_server's files have", key), "none");
  }

  // A number alone, or several in brackets: [0, 0, 0].
  template <std::size_t kNumbers>
  std::array<double, kNumbers> numbers(const std::string& key) const {
    const Value& value = at(key);
    const std::string expected = fmt::format("{} after '{}:'", counted(kNumbers, "number"), key);
    std::string_view list = value.text;
    if (kNumbers > 1 && list.size() >= 2 && list.front() == '[' && list.back() == ']')
      list = list.substr(1, list.size() - 2);
    std::string words(list);
    if (kNumbers > 1) std::replace(words.begin(), words.end(), ',', ' ');
    const std::vector<double> found = nn::parse_numbers(words, fmt::format("{}, {}", value.place, expected));
    if (found.size() != kNumbers) throw InputError(value.place, expected, printable(value.text));
    std::array<double, kNumbers> numbers{};
    std::copy(found.begin(), found.end(), numbers.begin());
    return numbers;
  }
  double number(const std::string& key) const { return numbers<1>(key)[0]; }

 private:
  std::string path_;
  std::map<std::string, Value> values_;
};

}  // namespace

PlanFile read_plan_file(const std::filesystem::path& yaml) {
  const KeyedLines lines(yaml);
  PlanFile plan;
  plan.cell = lines.number("resolution");
  if (!(plan.cell >= PlanFile::kLeastCell && plan.cell <= PlanFile::kMostCell)) {
    throw InputError(
        lines.at("resolution").place,
        fmt::format("a resolution above 0: {:g} to {:g} metres", PlanFile::kLeastCell, PlanFile::kMostCell),
        fmt::to_string(plan.cell));
  }
  const auto [x, y, turn] = lines.numbers<3>("origin");
  const std::string& origin_place = lines.at("origin").place;
  if (turn != 0.0) throw InputError(origin_place, "a plan that is not turned", fmt::format("{} rad", turn));
  if (std::max(std::abs(x), std::abs(y)) > PlanFile::kFarthestOrigin) {
    throw InputError(origin_place,
                     fmt::format("an origin within {:.0f} metres of 0", PlanFile::kFarthestOrigin),
                     fmt::format("{}, {}", x, y));
  }
  plan.origin = {x, y};
  plan.negate = lines.number("negate") != 0.0;
  plan.occupied = lines.number("occupied_thresh");
  plan.free = lines.number("free_thresh");
  const auto& [image, image_place] = lines.at("image");
  if (image.empty() || printable(image, image.size()) != image)
    throw InputError(image_place, "the name of an image after 'image:'",
                     fmt::format("'{}'", printable(image)));
  plan.image = image;
  return plan;
}

}  // namespace penumbra::slam
