#include "slam/datasets/image_list.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "nn/io/number_file.h"
#include "slam/geometry/time_unit.h"

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
  TimeRule times;
};
constexpr Form kTum{"SECONDS NAME", " \t", kCameraSeconds};
constexpr Form kEuroc{"NANOSECONDS,NAME", ",", kCameraNanoseconds};

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
    list.notes.push_back(
        fmt::format("{}: {} images have the time of the one before and are left out, first {}", file,
                    left_out, printable(first_left_out, kLongestQuote)));
  }
  list.images = std::move(kept);
}

ImageList read_list(const std::filesystem::path& path, const Form& form) {
  ImageList list;
  std::vector<FileTime> times;
  std::vector<int> lines;
  nn::LineReader reader(path, fmt::format("a list of images ({} a line)", form.line));
  while (const std::optional<std::string_view> content = reader.next()) {
    const std::size_t split = content->find_first_of(form.separators);
    if (split == std::string_view::npos) {
      throw InputError(reader.place(), form.line, fmt::format("'{}'", printable(*content, kLongestQuote)));
    }
    times.push_back(parse_file_time(trimmed(content->substr(0, split)), reader.place()));
    lines.push_back(reader.line());
    ListedImage image;
    image.name = trimmed(content->substr(split + 1));
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

}  // namespace

ImageList read_tum_image_list(const std::filesystem::path& path) { return read_list(path, kTum); }

ImageList read_euroc_image_list(const std::filesystem::path& path) { return read_list(path, kEuroc); }

std::vector<std::string> joined_notes(const ImageList& first, const ImageList& second) {
  std::vector<std::string> notes = first.notes;
  notes.insert(notes.end(), second.notes.begin(), second.notes.end());
  return notes;
}

std::vector<double> times_of(const std::vector<ListedImage>& images) {
  std::vector<double> times;
  for (const ListedImage& image : images) times.push_back(image.timestamp);
  return times;
}

}  // namespace penumbra::slam
