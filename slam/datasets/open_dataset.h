// Opens a stereo sequence of any layout that Penumbra reads, told by the folder's content.
//
//   KITTI odometry   ROOT/sequences/NN/{calib.txt,times.txt,image_0/,image_1/,...} and ROOT/poses/NN.txt;
//                    PATH is ROOT or the sequence's own folder (slam/datasets/kitti.h)
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "slam/datasets/frame_range.h"
#include "slam/datasets/stereo_dataset.h"

namespace penumbra::slam {

enum class DatasetFormat { automatic, kitti };
// "auto" or "kitti"; throws UsageError for another name.
DatasetFormat parse_dataset_format(std::string_view name);

enum class DatasetCameras { automatic, grey, colour };  // automatic: grey where there are grey images

struct DatasetOptions {
  DatasetFormat format = DatasetFormat::automatic;
  std::string sequence;  // where PATH holds several; may be empty where it holds one
  FrameRange frames;     // the part to read
  DatasetCameras cameras = DatasetCameras::automatic;
  std::optional<double> frame_rate;  // Hz, used where the dataset has no times; none: then an error
};

// Throws InputError where the folder is missing, of no known layout (the message lists what was looked for)
// or damaged, and UsageError where `options` ask for something that is not there.
std::unique_ptr<StereoDataset> open_dataset(const std::filesystem::path& path,
                                            const DatasetOptions& options = {});

}  // namespace penumbra::slam
