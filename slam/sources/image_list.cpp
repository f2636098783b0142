#include "slam/sources/image_list.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/number_file.h"
#include "nn/base/text.h"
#include "slam/geometry/time_unit.h"
#include "slam/sources/time_list.h"

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

// The form of a list.
struct Form {
  const char* line;
  std::string_view separators;
  std::string_view folder;  // of the images, which names may have before them
  TimeRule times;
};
constexpr Form kTum{"SECONDS NAME", " \t", "", kCameraSeconds};
constexpr Form kEuroc{"NANOSECONDS,NAME", ",", "data/", kCameraNanoseconds};

// What follows the first time in a line of associate.py: "NAME SECONDS NAME".
bool is_association(std::string_view rest) {
  const std::size_t first = rest.find_first_of(kBlank), last = rest.find_last_of(kBlank);
  if (first == std::string_view::npos || first == last) return false;
  const std::string_view middle = trimmed(rest.substr(first, last - first));
  return !middle.empty() && middle.find_first_not_of("0123456789.") == std::string_view::npos;
}

// Leaves out images whose time is that of the one before. Throws InputError where time goes back.
void keep_increasing(ImageList& list, const std::string& file, const std::vector<int>& lines) {
  std::vector<ListedImage> kept;
  std::string first_left_out;
  for (std::size_t i = 0; i < list.images.size(); ++i) {
    ListedImage& image = list.images[i];
    if (kept.empty() || image.timestamp > kept.back().timestamp) {
      kept.push_back(std::move(image));
    } else if (image.timestamp == kept.back().timestamp) {
      if (first_left_out.empty()) first_left_out = image.name;
    } else {
      throw InputError(fmt::format("{}:{}", file, lines[i]),
                       fmt::format("a time after {:.6f} s", kept.back().timestamp),
                       fmt::format("{:.6f} s", image.timestamp));
    }
  }
  const std::size_t left_out = list.images.size() - kept.size();
  if (left_out > 0) {
    list.notes.push_back(fmt::format("{}: left out: {} with the time of the one before, first {}", file,
                                     counted(left_out, "image"), printable(first_left_out, kLongestQuote)));
  }
  list.images = std::move(kept);
}

ImageList read_list(const std::filesystem::path& path, const Form& form) {
  ImageList list;
  std::vector<FileTime> times;
  std::vector<int> lines;
  nn::LineReader reader(path, fmt::format("a list of images ({} a line)", form.line));
  bool is_first = true;
  while (const std::optional<std::string_view> content = reader.next()) {
    if (std::exchange(is_first, false) && is_heading(*content)) {
      list.notes.push_back(heading_note(reader.place(), *content));
      continue;
    }
    const std::size_t split = content->find_first_of(form.separators);
    if (split == std::string_view::npos) {
      throw InputError(reader.place(), form.line, fmt::format("'{}'", printable(*content, kLongestQuote)));
    }
    times.push_back(parse_file_time(trimmed(content->substr(0, split)), reader.place()));
    lines.push_back(reader.line());
    ListedImage image;
    std::string_view name = trimmed(content->substr(split + 1));
    if (is_association(name)) {
      throw InputError(reader.place(), form.line,
                       fmt::format("two times and two names, as in an association file: '{}'",
                                   printable(*content, kLongestQuote)));
    }
    if (name.starts_with(form.folder)) name.remove_prefix(form.folder.size());
    image.name = name;
    if (!stays_in_folder(image.name)) {
      throw InputError(reader.place(), "the name of an image in this folder",
                       fmt::format("'{}'", printable(image.name, kLongestQuote)));
    }
    list.images.push_back(std::move(image));
  }
  if (list.images.empty()) throw InputError(path.string(), "images", "an empty list");
  const std::vector<double> seconds = to_seconds(times, form.times, path.string(), list.notes);
  for (std::size_t i = 0; i < seconds.size(); ++i) list.images[i].timestamp = seconds[i];
  keep_increasing(list, path.string(), lines);
  return list;
}

std::vector<double> times_of(const std::vector<ListedImage>& images) {
  std::vector<double> times;
  for (const ListedImage& image : images) times.push_back(image.timestamp);
  return times;
}

// For errors: how near the times of two lists come to each other.
std::string nearest_times(const ImageList& first, const ImageList& second) {
  double nearest = HUGE_VAL;
  for (std::size_t i = 0, j = 0; i < first.images.size() && j < second.images.size();) {
    const double difference = first.images[i].timestamp - second.images[j].timestamp;
    nearest = std::min(nearest, std::abs(difference));
    ++(difference < 0.0 ? i : j);
  }
  return fmt::format("none: the nearest two are {:.4g} s apart", nearest);
}

}  // namespace

ImageList read_tum_image_list(const std::filesystem::path& path) { return read_list(path, kTum); }

ImageList read_euroc_image_list(const std::filesystem::path& path) { return read_list(path, kEuroc); }

std::vector<std::string> joined_notes(const ImageList& first, const ImageList& second) {
  std::vector<std::string> notes = first.notes;
  notes.insert(notes.end(), second.notes.begin(), second.notes.end());
  return notes;
}

std::vector<TimePair> pair_by_time(const ImageList& first, const ImageList& second, double within,
                                   const PairingTexts& texts, std::vector<std::string>& notes) {
  std::vector<TimePair> pairs = associate_times(times_of(first.images), times_of(second.images), within);
  if (pairs.empty()) {
    throw InputError(texts.place, fmt::format(fmt::runtime(texts.expected), within),
                     nearest_times(first, second) + " (--pair-within)");
  }
  const std::size_t alone = first.images.size() + second.images.size() - 2 * pairs.size();
  if (alone > 0) {
    notes.push_back(fmt::format("{} of {} {} and {} {}; left out: {} without a partner within {:g} s",
                                counted(pairs.size(), "pair"), first.images.size(), texts.first,
                                second.images.size(), texts.second, counted(alone, "image"), within));
  }
  return pairs;
}

}  // namespace penumbra::slam
