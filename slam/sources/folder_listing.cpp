#include "slam/sources/folder_listing.h"

#include <algorithm>
#include <cctype>
#include <span>
#include <string>
#include <string_view>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/natural_order.h"
#include "nn/base/text.h"
#include "nn/image/image_file.h"

namespace penumbra::slam {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kRead[] = {".png", ".jpg", ".jpeg", ".pgm", ".ppm", ".bmp"};
constexpr std::string_view kForeign[] = {".tif", ".tiff", ".webp", ".gif", ".jp2", ".jxl", ".exr", ".heic"};

bool ends_in_one_of(const fs::path& path, std::span<const std::string_view> endings) {
  return std::find(endings.begin(), endings.end(), nn::image_ending(path)) != endings.end();
}

}  // namespace

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool is_present(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

bool is_debris(const fs::path& path) {
  const std::string name = lower_case(path.filename().string());
  return name.starts_with("._") || name == ".ds_store" || name == "thumbs.db" || name == "desktop.ini" ||
         name == "@eadir" || name == "__macosx";
}

std::vector<fs::path> list_folder(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (!is_debris(entry->path())) entries.push_back(entry->path());
  }
  if (error) throw InputError(folder.string(), "a folder", error.message());
  std::sort(entries.begin(), entries.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return entries;
}

std::vector<fs::path> list_images(const fs::path& folder, std::vector<std::string>& notes) {
  if (!is_folder(folder)) {
    throw InputError(folder.string(), "a folder of images", is_present(folder) ? "a file" : "nothing");
  }
  std::vector<fs::path> images, foreign;
  for (const fs::path& entry : list_folder(folder)) {
    if (ends_in_one_of(entry, kRead)) images.push_back(entry);
    if (ends_in_one_of(entry, kForeign)) foreign.push_back(entry);
  }
  if (!images.empty()) {
    if (!foreign.empty()) {
      notes.push_back(fmt::format("{}: left out: {} of a kind that is not read, first {}", folder.string(),
                                  counted(foreign.size(), "image"),
                                  printable(foreign.front().filename().string(), 60)));
    }
    return images;
  }
  constexpr std::string_view kExpected = "images (.png, .jpg, .pgm, .ppm or .bmp)";
  if (!foreign.empty()) {
    throw InputError(folder.string(), kExpected,
                     fmt::format("only {0} (ImageMagick converts them: mogrify -format png '{1}'/*{0})",
                                 foreign.front().extension().string(), folder.string()));
  }
  throw InputError(folder.string(), kExpected, "none");
}

std::optional<double> number_in_name(std::string_view name) {
  std::size_t begin = name.size();
  while (begin > 0 && name[begin - 1] >= '0' && name[begin - 1] <= '9') --begin;
  if (begin == name.size() || name.size() - begin > 15) return std::nullopt;
  double number = 0.0;
  for (const char digit : name.substr(begin)) number = 10.0 * number + (digit - '0');
  return number;
}

void require_dataset_folder(const fs::path& path) {
  constexpr const char* kExpected = "the folder of a dataset, or a ROS bag or MCAP file";
  if (!is_present(path)) throw InputError(path.string(), kExpected, "nothing");
  if (!is_folder(path)) throw InputError(path.string(), kExpected, "a file");
  if (list_folder(path).empty()) throw InputError(path.string(), kExpected, "an empty folder");
}

}  // namespace penumbra::slam
