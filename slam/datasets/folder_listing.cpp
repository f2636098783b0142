#include "slam/datasets/folder_listing.h"

#include <algorithm>
#include <string>

#include "nn/base/error.h"

namespace penumbra::slam {

namespace fs = std::filesystem;

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool is_present(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error);
}

std::vector<fs::path> list_folder(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    entries.push_back(entry->path());
  }
  if (error) throw InputError(folder.string(), "a folder", error.message());
  std::sort(entries.begin(), entries.end());
  return entries;
}

std::vector<fs::path> list_images(const fs::path& folder) {
  if (!is_folder(folder)) {
    throw InputError(folder.string(), "a folder of images", is_present(folder) ? "a file" : "nothing");
  }
  std::vector<fs::path> images;
  for (const fs::path& entry : list_folder(folder)) {
    const std::string ending = entry.extension().string();
    if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") images.push_back(entry);
  }
  if (images.empty()) throw InputError(folder.string(), "images (.png or .jpg)", "none");
  return images;
}

void require_dataset_folder(const fs::path& path) {
  constexpr const char* kExpected = "the folder of a dataset";
  if (!is_present(path)) throw InputError(path.string(), kExpected, "nothing");
  if (!is_folder(path)) throw InputError(path.string(), kExpected, "a file");
  if (list_folder(path).empty()) throw InputError(path.string(), kExpected, "an empty folder");
}

}  // namespace penumbra::slam
