#include "slam/sources/image_pairs.h"

#include <cctype>
#include <map>
#include <optional>
#include <span>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/natural_order.h"
#include "nn/base/text.h"
#include "slam/sources/folder_listing.h"

namespace penumbra::slam {

namespace {

constexpr std::string_view kFirst[] = {"left", "cam0", "l", "rgb", "color", "colour", "image"};
constexpr std::string_view kSecond[] = {"right", "cam1", "r", "depth"};

bool is_separator(char c) { return c == '_' || c == '-' || c == '.' || c == ' '; }
bool equal_letters(std::string_view a, std::string_view small) { return lower_case(a) == small; }

// The name without `side` at its begin or end; none where it is not there. A letter must not be next to it.
std::optional<std::string_view> without_side(std::string_view name, std::string_view side) {
  if (name.size() <= side.size()) return std::nullopt;
  const std::size_t rest = name.size() - side.size();
  const auto is_cut = [&](char c) { return is_separator(c) || (is_digit(c) && !is_digit(side.back())); };
  if (equal_letters(name.substr(0, side.size()), side) && is_cut(name[side.size()])) {
    name.remove_prefix(side.size() + (is_separator(name[side.size()]) ? 1 : 0));
  } else if (equal_letters(name.substr(rest), side) &&
             (is_separator(name[rest - 1]) || is_digit(name[rest - 1]))) {
    name = name.substr(0, is_separator(name[rest - 1]) ? rest - 1 : rest);
  } else {
    return std::nullopt;
  }
  if (name.empty()) return std::nullopt;
  return name;
}

// Takes `side` off all names, if all have it.
bool take_side(std::vector<NamedImage>& images, std::string_view side) {
  std::vector<std::string> names;
  for (const NamedImage& image : images) {
    const std::optional<std::string_view> name = without_side(image.name, side);
    if (!name) return false;
    names.emplace_back(*name);
  }
  for (std::size_t i = 0; i < images.size(); ++i) images[i].name = std::move(names[i]);
  return true;
}

bool is_png(const std::filesystem::path& path) { return equal_letters(path.extension().string(), ".png"); }

std::vector<NamedImage> list_named(const std::filesystem::path& folder, std::vector<std::string>& notes) {
  std::vector<NamedImage> images;
  std::map<std::string, std::size_t> places;  // by name
  std::size_t twins = 0;
  std::string taken, left_out;  // of the first twins
  for (const std::filesystem::path& path : list_images(folder, notes)) {
    const auto [at, is_new] = places.try_emplace(path.stem().string(), images.size());
    if (is_new) {
      images.push_back({path, at->first});
      continue;
    }
    std::filesystem::path& chosen = images[at->second].path;
    std::filesystem::path other = path;
    if (is_png(other) && !is_png(chosen)) std::swap(chosen, other);
    if (twins++ > 0) continue;
    taken = chosen.filename().string();
    left_out = other.filename().string();
  }
  if (twins > 0) {
    notes.push_back(
        fmt::format("{}: there in two files of one name, of which one is taken: {}, such as {} and not {}",
                    folder.string(), counted(twins, "image"), printable(taken, 40), printable(left_out, 40)));
  }
  return images;
}

void take_any_side(std::vector<NamedImage>& images, std::span<const std::string_view> sides) {
  for (const std::string_view side : sides) {
    if (take_side(images, side)) return;
  }
}

struct NaturalLess {
  bool operator()(const std::string& a, const std::string& b) const { return natural_less(a, b); }
};
// Where a name stands in the two lists.
struct Places {
  std::optional<std::size_t> first, second;
};

void find_pairs(ImagePairs& result) {
  std::map<std::string, Places, NaturalLess> names;
  const auto note = [&](const std::vector<NamedImage>& images, std::optional<std::size_t> Places::*list) {
    for (std::size_t i = 0; i < images.size(); ++i) {
      std::optional<std::size_t>& place = names[images[i].name].*list;
      if (!place) place = i;
    }
  };
  note(result.first, &Places::first);
  note(result.second, &Places::second);
  result.names = names.size();
  std::size_t place = 0;
  for (const auto& [name, places] : names) {
    if (places.first && places.second) result.pairs.push_back({*places.first, *places.second, place});
    ++place;
  }
  result.alone = result.first.size() + result.second.size() - 2 * result.pairs.size();
}

}  // namespace

ImagePairs pair_images(const std::filesystem::path& first, const std::filesystem::path& second) {
  ImagePairs result;
  result.first = list_named(first, result.notes);
  result.second = list_named(second, result.notes);
  find_pairs(result);
  if (!result.pairs.empty()) return result;
  take_any_side(result.first, kFirst);
  take_any_side(result.second, kSecond);
  find_pairs(result);
  if (!result.pairs.empty()) return result;
  throw InputError(second.string(), fmt::format("images of the same names as in {}", first.string()),
                   fmt::format("none, such as '{}' beside '{}'",
                               printable(result.second.front().path.filename().string(), 40),
                               printable(result.first.front().path.filename().string(), 40)));
}

}  // namespace penumbra::slam
