#include "slam/sources/open_dataset.h"

#include <algorithm>
#include <string>
#include <vector>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "slam/sources/bag/message_source.h"
#include "slam/sources/bag_recording.h"
#include "slam/sources/euroc.h"
#include "slam/sources/folder_listing.h"
#include "slam/sources/image_folder.h"
#include "slam/sources/kitti.h"
#include "slam/sources/published.h"
#include "slam/sources/tum.h"

namespace penumbra::slam {

namespace {

struct Layout {
  DatasetFormat format;
  const char* name;
  bool (*looks_like)(const std::filesystem::path&);
  std::unique_ptr<StereoDataset> (*open)(const std::filesystem::path&, const DatasetOptions&);
};

// In the order in which they are tried: TUM's folders may have a calibration.yaml, too, and ICL-NUIM's look
// like TUM's.
constexpr Layout kLayouts[] = {
    {DatasetFormat::bag, "bag", looks_like_bag, open_bag_recording},
    {DatasetFormat::kitti, "kitti", looks_like_kitti, open_kitti},
    {DatasetFormat::euroc, "euroc", looks_like_euroc, open_euroc},
    {DatasetFormat::published, "published", looks_like_published, open_published},
    {DatasetFormat::tum, "tum", looks_like_tum, open_tum},
    {DatasetFormat::folder, "folder", looks_like_image_folder, open_image_folder},
};

// Layouts that are not read, by what is only in them.
constexpr struct {
  const char* mark;
  const char* name;
} kForeign[] = {
    {"calib_cam_to_cam.txt", "a day of KITTI's raw data (its drives are read)"},
    {"data_2d_raw", "all of KITTI-360 (its drives, data_2d_raw/NAME, are read)"},
    {"distorted_images", "4Seasons' distorted images"},
    {"stereo.timestamps", "RobotCar's layout without stereo/left (or centre) and stereo/right"},
    {"aligned_depth.txt", "OpenLORIS' layout without its color.txt"},
    {"rgb_left", "a layout with rgb_left/"},
    {"metadata.yaml", "the folder of a ROS 2 bag without its .mcap or .db3 file"},
};

// What a folder of no layout holds, for "found ...".
std::string describe_folder(const std::filesystem::path& path) {
  constexpr std::size_t kShown = 6, kLongestName = 40;
  std::string found = "a folder with none of these";
  for (const auto& [mark, name] : kForeign) {
    if (!is_present(path / mark)) continue;
    found = fmt::format("what looks like {}, which is not read", name);
    break;
  }
  const std::vector<std::filesystem::path> entries = list_folder(path);
  for (std::size_t i = 0; i < std::min(kShown, entries.size()); ++i) {
    found += fmt::format("{}{}{}", i == 0 ? ", but " : ", ",
                         printable(entries[i].filename().string(), kLongestName),
                         is_folder(entries[i]) ? "/" : "");
  }
  if (entries.size() > kShown) found += fmt::format(" and {} more", entries.size() - kShown);
  return found;
}

}  // namespace

DatasetFormat parse_dataset_format(std::string_view name) {
  if (name == "auto") return DatasetFormat::automatic;
  for (const Layout& layout : kLayouts) {
    if (name == layout.name) return layout.format;
  }
  throw UsageError(
      fmt::format("format '{}': expected auto, kitti, euroc, published, tum, folder or bag", name));
}

std::unique_ptr<StereoDataset> open_dataset(const std::filesystem::path& path,
                                            const DatasetOptions& options) {
  const bool is_bag = options.format == DatasetFormat::bag || looks_like_bag(path);
  if (!is_bag) require_dataset_folder(path);
  if (!is_bag && !(options.topics.empty() && options.camera.empty())) {
    throw UsageError(
        fmt::format("{}: topics and --camera are of use for ROS bags and MCAP files alone", path.string()));
  }
  if (options.step < 1) throw UsageError(fmt::format("step {}: expected at least 1", options.step));
  for (const Layout& layout : kLayouts) {
    const bool chosen = options.format == layout.format ||
                        (options.format == DatasetFormat::automatic && layout.looks_like(path));
    if (!chosen) continue;
    if (layout.format != DatasetFormat::kitti && !options.sequence.empty()) {
      throw UsageError(fmt::format("{}: sequences are chosen by name in KITTI's layout only, not '{}'",
                                   path.string(), options.sequence));
    }
    return layout.open(path, options);
  }
  throw InputError(
      path.string(),
      "a recording: KITTI odometry (sequences/, or calib.txt and image_0/ or image_2/), EuRoC or TUM-VI "
      "(mav0/), TUM RGB-D, ETH3D, Bonn or OpenLORIS (rgb.txt or color.txt), a folder of your own images "
      "(calibration.yaml), or as downloaded KITTI raw, KITTI-360, Virtual KITTI 2, TartanAir, 4Seasons, "
      "ICL-NUIM or RobotCar (docs/datasets.md has the layouts)",
      describe_folder(path));
}

}  // namespace penumbra::slam
