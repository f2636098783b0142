#include "slam/datasets/open_dataset.h"

#include "nn/base/error.h"
#include "slam/datasets/kitti.h"

namespace penumbra::slam {

DatasetFormat parse_dataset_format(std::string_view name) {
  if (name == "auto") return DatasetFormat::automatic;
  if (name == "kitti") return DatasetFormat::kitti;
  throw UsageError(fmt::format("format '{}': expected auto or kitti", name));
}

std::unique_ptr<StereoDataset> open_dataset(const std::filesystem::path& path,
                                            const DatasetOptions& options) {
  require_dataset_folder(path);
  if (options.format == DatasetFormat::kitti || looks_like_kitti(path)) return open_kitti(path, options);
  throw InputError(path.string(),
                   "a dataset: KITTI odometry has sequences/ (dataset root), or calib.txt, image_0/ or "
                   "image_2/ (folder of one sequence)",
                   "a folder with none of these");
}

}  // namespace penumbra::slam
