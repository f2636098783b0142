#include "slam/datasets/image_list.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/io/file.h"
#include "nn/io/number_file.h"

namespace penumbra::slam {

namespace {

constexpr std::string_view kBlank = " \t\r";
constexpr std::size_t kLongestQuote = 60;

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

bool stays_in_folder(std::string_view name) {
  const std::filesystem::path path(name);
  return !name.empty() && path.is_relative() && std::find(path.begin(), path.end(), "..") == path.end() &&
         name.find('\0') == std::string_view::npos;
}

// Nanoseconds since 1970 need more digits than a double has: the fraction is added last.
double parse_nanoseconds(std::string_view text, const std::string& place) {
  long long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0) {
    throw InputError(place, "a time in whole nanoseconds",
                     fmt::format("'{}'", printable(text, kLongestQuote)));
  }
  constexpr long long kSecond = 1'000'000'000;
  return static_cast<double>(value / kSecond) + 1e-9 * static_cast<double>(value % kSecond);
}

double parse_seconds(std::string_view text, const std::string& place) {
  const std::vector<double> numbers = nn::parse_numbers(text, place);
  if (numbers.size() != 1) throw InputError(place, "a time in seconds", "nothing");
  return numbers.front();
}

std::vector<ListedImage> read_list(const std::filesystem::path& path, std::string_view separators,
                                   const char* form,
                                   double (*parse_time)(std::string_view, const std::string&)) {
  const std::string text = nn::read_text_file(path, fmt::format("a list of images ({} a line)", form));
  std::vector<ListedImage> images;
  int line = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t stop = std::min(text.find('\n', start), text.size());
    const std::string_view content = trimmed(std::string_view(text).substr(start, stop - start));
    start = stop + 1;
    ++line;
    if (content.empty() || content.front() == '#') continue;
    const std::string place = fmt::format("{}:{}", path.string(), line);
    const std::size_t split = content.find_first_of(separators);
    if (split == std::string_view::npos) {
      throw InputError(place, form, fmt::format("'{}'", printable(content, kLongestQuote)));
    }
    ListedImage image;
    image.timestamp = parse_time(trimmed(content.substr(0, split)), place);
    image.name = trimmed(content.substr(split + 1));
    if (!stays_in_folder(image.name)) {
      throw InputError(place, "the name of an image in this folder",
                       fmt::format("'{}'", printable(image.name, kLongestQuote)));
    }
    if (!images.empty() && !(image.timestamp > images.back().timestamp)) {
      throw InputError(place, fmt::format("a time after {:.6f} s", images.back().timestamp),
                       fmt::format("{:.6f} s", image.timestamp));
    }
    images.push_back(std::move(image));
  }
  if (images.empty()) throw InputError(path.string(), "images", "an empty list");
  return images;
}

}  // namespace

std::vector<ListedImage> read_tum_image_list(const std::filesystem::path& path) {
  return read_list(path, " \t", "SECONDS NAME", parse_seconds);
}

std::vector<ListedImage> read_euroc_image_list(const std::filesystem::path& path) {
  return read_list(path, ",", "NANOSECONDS,NAME", parse_nanoseconds);
}

std::vector<double> times_of(const std::vector<ListedImage>& images) {
  std::vector<double> times;
  for (const ListedImage& image : images) times.push_back(image.timestamp);
  return times;
}

}  // namespace penumbra::slam
