#include "apps/network/image_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>

#include "apps/common/log.h"
#include "nn/base/error.h"
#include "nn/image/exif.h"
#include "nn/image/image_file.h"
#include "slam/sources/folder_listing.h"
#include "slam/sources/image_levels.h"

namespace penumbra::apps {

namespace {

nn::CocoImageId id_from_name(const std::filesystem::path& path) {
  constexpr std::size_t kMostDigits = 18;  // fit 64 bits
  const std::string stem = path.stem().string();
  const bool digits = stem.find_first_not_of("0123456789") == std::string::npos;
  if (digits && !stem.empty() && stem.size() <= kMostDigits) return std::int64_t{std::stoll(stem)};
  return stem;
}

// Images, also of formats that are not read: each of those is then named as such, as it is by itself.
bool has_image_ending(const std::filesystem::path& path) {
  const std::string ending = nn::image_ending(path);
  constexpr std::array kEndings = {".png",  ".jpg",  ".jpeg", ".jpe", ".jfif", ".pgm",
                                   ".ppm",  ".pnm",  ".bmp",  ".tif", ".tiff", ".webp",
                                   ".heic", ".heif", ".avif", ".gif", ".jp2",  ".jxl"};
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

std::vector<std::filesystem::path> images_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files = slam::list_folder(folder);
  std::erase_if(files, [](const std::filesystem::path& file) {
    const bool is_hidden = file.filename().string().starts_with(".");
    return is_hidden || !has_image_ending(file);
  });
  if (files.empty())
    throw InputError(folder.string(), "a folder with PNG, JPEG, PGM or BMP images", "none in it");
  return files;
}

// Of 16-bit files the bits that are filled count, as in recordings; here each image is judged by itself.
ByteImage read_photograph(const std::filesystem::path& path, nn::ImageOrientation orientation) {
  const nn::ImageInfo info = nn::read_image_info(path);
  if (info.bit_depth != 16) return nn::read_image(path, nn::ImageColour::bgr, orientation);
  std::vector<std::string> unused;
  const std::shared_ptr<const slam::ImageReader> files = slam::file_images();
  const slam::ImageKey image_file(path);
  const slam::ImageLevels levels(*files, std::span(&image_file, 1), std::nullopt, unused);
  if (levels.bits() < 16) log_warning("{}: {} of 16 bits are taken to be used", path.string(), levels.bits());
  const ByteImage image = levels.read(*files, image_file, nn::ImageColour::bgr);
  return orientation == nn::ImageOrientation::upright ? nn::turn_upright(image, info.orientation) : image;
}

}  // namespace

std::vector<ListedImage> list_files(const std::vector<std::string>& paths) {
  std::vector<ListedImage> images;
  const auto add = [&](const std::filesystem::path& path) {
    images.push_back({path, id_from_name(path), std::nullopt});
  };
  for (const std::string& path : paths) {
    if (std::filesystem::is_directory(path)) {
      for (const std::filesystem::path& file : images_in(path)) add(file);
    } else if (!slam::is_debris(path)) {  // which wildcards find as well
      add(path);
    }
  }
  return images;
}

std::vector<ListedImage> list_coco_images(const std::filesystem::path& folder,
                                          const nn::CocoAnnotations& data_set) {
  std::vector<ListedImage> images;
  for (std::size_t i = 0; i < data_set.images.size(); ++i) {
    const nn::CocoImage& image = data_set.images[i];
    if (image.file_name.empty()) {
      throw InputError(fmt::format("{}: images, entry {}", data_set.file, i), "a file_name", "none");
    }
    std::optional<Size> size;
    if (image.width > 0 && image.height > 0) size = Size{image.width, image.height};
    images.push_back({folder / image.file_name, image.id, size});
  }
  return images;
}

ByteImage read_listed_image(const ListedImage& listed, nn::ImageOrientation orientation) {
  ByteImage image = read_photograph(listed.path, orientation);
  // The annotations of some data sets were made on the rows as they lie in the file.
  if (listed.size && image.size() != *listed.size && Size{image.height(), image.width()} == *listed.size) {
    image = read_photograph(listed.path, nn::ImageOrientation::sensor);
  }
  if (listed.size && image.size() != *listed.size) {
    throw InputError(
        listed.path.string(),
        fmt::format("{} x {} pixels as in the annotations", listed.size->width, listed.size->height),
        fmt::format("{} x {}", image.width(), image.height()));
  }
  return image;
}

void add_orientation_option(CLI::App* command, nn::ImageOrientation& orientation) {
  command->add_flag_callback(
      "--ignore-exif", [&] { orientation = nn::ImageOrientation::sensor; },
      "take photographs as their rows lie in the file, not turned upright as their EXIF data say");
}

std::filesystem::path picture_name(const ListedImage& image) {
  return image.path.stem().string() + "_overlay.png";
}

void check_picture_names(const std::vector<ListedImage>& images) {
  std::map<std::filesystem::path, std::filesystem::path> image_of;
  for (const ListedImage& image : images) {
    const auto [at, is_new] = image_of.emplace(picture_name(image), image.path);
    if (!is_new) {
      throw UsageError(fmt::format("{} and {}: images of one name, their pictures would overwrite each other",
                                   at->second.string(), image.path.string()));
    }
  }
}

std::vector<std::optional<std::int64_t>> category_ids(const std::vector<std::string>& class_names,
                                                      const nn::CocoAnnotations& data_set) {
  std::map<std::string, std::int64_t> id_of_name;
  for (const nn::CocoCategory& category : data_set.categories) {
    id_of_name.emplace(category.name, category.id);
  }
  std::vector<std::optional<std::int64_t>> ids;
  for (const std::string& name : class_names) {
    const auto found = id_of_name.find(name);
    ids.push_back(found == id_of_name.end() ? std::nullopt : std::optional(found->second));
  }
  if (std::none_of(ids.begin(), ids.end(), [](const auto& id) { return id.has_value(); })) {
    throw InputError(data_set.file, "categories named as the network's classes",
                     fmt::format("none of {} (--classes FILE names the classes)", class_names.size()));
  }
  return ids;
}

}  // namespace penumbra::apps
