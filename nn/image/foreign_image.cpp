#include "nn/image/foreign_image.h"

#include <fmt/format.h>

#include <array>

#include "nn/base/text.h"

namespace penumbra::nn {

namespace {

enum class Remedy { imagemagick, heif, video, download, none };

struct ForeignFormat {
  std::size_t offset;  // where `magic` stands
  std::string_view magic;
  std::string_view name;
  Remedy remedy;
};

// Magic numbers as in the file(1) database. Of two that fit the first counts.
constexpr std::array kFormats = {
    ForeignFormat{0, {"II*\0", 4}, "a TIFF image", Remedy::imagemagick},
    ForeignFormat{0, {"MM\0*", 4}, "a TIFF image", Remedy::imagemagick},
    ForeignFormat{0, {"II+\0", 4}, "a BigTIFF image", Remedy::imagemagick},
    ForeignFormat{0, {"MM\0+", 4}, "a BigTIFF image", Remedy::imagemagick},
    ForeignFormat{8, "WEBP", "a WebP image", Remedy::imagemagick},
    ForeignFormat{8, "AVI ", "a video (AVI)", Remedy::video},
    ForeignFormat{0, "GIF8", "a GIF image", Remedy::imagemagick},
    ForeignFormat{4, "ftyphei", "a HEIC image", Remedy::heif},
    ForeignFormat{4, "ftyphev", "a HEIC image", Remedy::heif},
    ForeignFormat{4, "ftypmif1", "a HEIC image", Remedy::heif},
    ForeignFormat{4, "ftypmsf1", "a HEIC image", Remedy::heif},
    ForeignFormat{4, "ftypavi", "an AVIF image", Remedy::heif},
    ForeignFormat{4, "ftyp", "a video (MP4 or MOV)", Remedy::video},
    ForeignFormat{0, "\x1A\x45\xDF\xA3", "a video (Matroska or WebM)", Remedy::video},
    ForeignFormat{4, "jP  ", "a JPEG 2000 image", Remedy::imagemagick},
    ForeignFormat{0, "\xFF\x4F\xFF\x51", "a JPEG 2000 image", Remedy::imagemagick},
    ForeignFormat{4, "JXL ", "a JPEG XL image", Remedy::imagemagick},
    ForeignFormat{0, "\xFF\x0A", "a JPEG XL image", Remedy::imagemagick},
    ForeignFormat{0, "\x76\x2F\x31\x01", "an OpenEXR image", Remedy::imagemagick},
    ForeignFormat{0, "#?RADIANCE", "a Radiance HDR image", Remedy::imagemagick},
    ForeignFormat{0, "P1", "a PBM image", Remedy::imagemagick},
    ForeignFormat{0, "P4", "a PBM image", Remedy::imagemagick},
    ForeignFormat{0, "P7", "a PAM image", Remedy::imagemagick},
    ForeignFormat{0, "Pf\n", "a PFM image", Remedy::imagemagick},
    ForeignFormat{0, "PF\n", "a PFM image", Remedy::imagemagick},
    ForeignFormat{0, "8BPS", "a Photoshop image", Remedy::imagemagick},
    ForeignFormat{0, {"\0\0\1\0", 4}, "an icon", Remedy::imagemagick},
    ForeignFormat{0, {"\0\5\x16\7", 4}, "a file of macOS's own about another file", Remedy::none},
    ForeignFormat{0, "\x93NUMPY", "a numpy array", Remedy::none},
    ForeignFormat{0, "version https://git-lfs", "a pointer of git-lfs instead of the file", Remedy::download},
    ForeignFormat{0, "<", "a web page or XML", Remedy::none},
    ForeignFormat{0, "%PDF", "a PDF", Remedy::imagemagick},
    ForeignFormat{0, "PK\x03\x04", "a zip archive", Remedy::none},
    ForeignFormat{0, "\x1F\x8B", "a gzip archive", Remedy::none},
};

std::string advice(Remedy remedy, const std::filesystem::path& path) {
  const std::string from = printable(path.string(), 400);
  const std::string to = printable(std::filesystem::path(path).replace_extension(".png").string(), 400);
  switch (remedy) {
    case Remedy::imagemagick:
      return fmt::format(" (ImageMagick converts it: convert '{}' '{}')", from, to);
    case Remedy::heif:
      return fmt::format(" (libheif converts it: heif-convert '{}' '{}')", from, to);
    case Remedy::video:
      return fmt::format(" (ffmpeg writes its images: ffmpeg -i '{}' %06d.png)", from);
    case Remedy::download:
      return " (git lfs pull)";
    case Remedy::none:
      break;
  }
  return {};
}

}  // namespace

std::string describe_foreign_image(std::string_view bytes, const std::filesystem::path& path) {
  for (const ForeignFormat& format : kFormats) {
    if (bytes.size() < format.offset || !bytes.substr(format.offset).starts_with(format.magic)) continue;
    return std::string(format.name) + advice(format.remedy, path);
  }
  return fmt::format("a file that begins with '{}'", printable(bytes.substr(0, 16)));
}

}  // namespace penumbra::nn
