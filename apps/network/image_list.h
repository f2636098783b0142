// Which images a command goes through: files named one by one, or those of a COCO data set.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "nn/evaluation/coco_annotations.h"
#include "nn/image/image_file.h"

namespace penumbra::apps {

struct ListedImage {
  std::filesystem::path path;
  nn::CocoImageId id;        // in result files
  std::optional<Size> size;  // that it must have
};

// Files, and the images in folders (by their endings, in the order of the numbers in their names), with ids
// from their names: digits only are taken as a number, any other name stays a text. What macOS and Windows
// leave beside images (._NAME, .DS_Store, Thumbs.db) is passed over. Throws InputError for a folder without
// images.
std::vector<ListedImage> list_files(const std::vector<std::string>& paths);

// The images of a data set, in the order of its file; their file names are looked up in `folder`.
// Throws InputError where an image has no file name.
std::vector<ListedImage> list_coco_images(const std::filesystem::path& folder,
                                          const nn::CocoAnnotations& data_set);

// Reads the image as 8-bit BGR, turned upright as its EXIF data say unless `orientation` or the expected size
// ask for the sensor's rows. Throws InputError where it is not readable or of another size than expected.
ByteImage read_listed_image(const ListedImage& image, nn::ImageOrientation orientation);

// Adds --ignore-exif, which sets `orientation`.
void add_orientation_option(CLI::App* command, nn::ImageOrientation& orientation);

// "NAME_overlay.png" for an image "some/where/NAME.jpg".
std::filesystem::path picture_name(const ListedImage& image);

// Throws UsageError where the pictures of two images would overwrite each other.
void check_picture_names(const std::vector<ListedImage>& images);

// The category id of every class: the data set's category of the same name; none where it has no such one.
// Throws InputError where no class is a category.
std::vector<std::optional<std::int64_t>> category_ids(const std::vector<std::string>& class_names,
                                                      const nn::CocoAnnotations& data_set);

}  // namespace penumbra::apps
