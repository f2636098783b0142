// Image files, with errors that say what is wrong with them.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace penumbra::nn {

enum class ImageColour { grey, bgr };

// Reads an 8-bit PNG or JPEG (16-bit PNGs are scaled down), converted to grey or BGR; EXIF rotation is
// ignored. Throws InputError where the file is missing, is not an image, or ends before its last row (a torn
// file is never returned half-filled).
cv::Mat read_image(const std::filesystem::path& path, ImageColour colour);

// Reads a 16-bit grey PNG, such as a depth map, as it is. Throws InputError as above, and for any other
// image.
cv::Mat1w read_depth_image(const std::filesystem::path& path);

// Writes `image` (8-bit grey or BGR) in the format of the name's ending; throws Error where that fails.
void write_image(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace penumbra::nn
