// Files that stand where an image should, told by their first bytes.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace penumbra::nn {

// What the file is, for "found ...", with the command that makes a PNG of it where there is one: "a TIFF
// image (ImageMagick converts it: convert 'a.tif' 'a.png')". `path` is only named.
std::string describe_foreign_image(std::string_view bytes, const std::filesystem::path& path);

}  // namespace penumbra::nn
