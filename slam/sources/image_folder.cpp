#include "slam/sources/image_folder.h"

#include "nn/base/error.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/sources/folder_listing.h"
#include "slam/sources/paired_folders.h"
#include "slam/sources/time_list.h"

namespace penumbra::slam {

namespace fs = std::filesystem;

bool looks_like_image_folder(const fs::path& path) { return is_present(path / "calibration.yaml"); }

std::unique_ptr<StereoDataset> open_image_folder(const fs::path& path, const DatasetOptions& options) {
  require_dataset_folder(path);
  PairedFolders folders;
  folders.place = fs::canonical(path);
  folders.name = folders.place.filename().string();
  folders.camera = read_camera_file(folders.place / "calibration.yaml");
  const bool rgbd = folders.camera.sensor == Sensor::rgbd;
  folders.first = folders.place / (rgbd ? "rgb" : "left");
  folders.second = folders.place / (rgbd ? "depth" : "right");
  if (!rgbd && is_present(folders.place / "side_by_side")) {
    folders.first = folders.second = folders.place / "side_by_side";
    folders.side_by_side = true;
  } else if (!is_present(folders.first) && !is_present(folders.second)) {
    throw InputError(folders.place.string(),
                     rgbd ? "rgb/ and depth/ with images" : "left/ and right/, or side_by_side/, with images",
                     "neither");
  }
  if (const fs::path file = folders.place / "times.txt"; is_present(file))
    folders.times = {file, read_time_list(file, folders.notes)};
  if (const fs::path file = folders.place / "groundtruth.txt"; is_present(file)) {
    folders.truth = read_tum_trajectory(file, &folders.notes);
  } else if (const fs::path poses = folders.place / "poses.txt"; is_present(poses)) {
    folders.poses = {poses, read_kitti_poses(poses)};
  }
  return open_paired_folders(std::move(folders), options);
}

}  // namespace penumbra::slam
