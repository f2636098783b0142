// Opens a sequence of any layout that Penumbra reads, told by the folder's content.
//
//   KITTI odometry   ROOT/sequences/NN/{calib.txt,times.txt,image_0/,image_1/,...} and ROOT/poses/NN.txt;
//                    PATH is ROOT or the sequence's own folder (slam/sources/kitti.h)
//   EuRoC            mav0/cam0/{sensor.yaml,data.csv,data/}, mav0/cam1/...; PATH is the folder with mav0/, or
//                    mav0/ itself (slam/sources/euroc.h)
//   published        KITTI raw and 360, Virtual KITTI, TartanAir, 4Seasons, ICL-NUIM as they are downloaded
//                    (slam/sources/published.h)
//   TUM RGB-D        rgb.txt, depth.txt, rgb/, depth/ (slam/sources/tum.h)
//   bag              ROS 1 bags, MCAP, rosbag2: one file, or rosbag2's folder (slam/sources/bag_recording.h)
//   folder           calibration.yaml, left/ and right/, or rgb/ and depth/, or side_by_side/
//                    (slam/sources/image_folder.h)
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "slam/sources/frame_range.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

enum class DatasetFormat { automatic, kitti, euroc, published, tum, folder, bag };
// "auto", "kitti", "euroc", "published", "tum", "folder" or "bag"; throws UsageError for another name.
DatasetFormat parse_dataset_format(std::string_view name);

// Automatic: colour from RGB-D cameras, grey images where a stereo camera has them.
enum class DatasetCameras { automatic, grey, colour };

// Topics of a recording in one file; empty: found.
struct TopicNames {
  std::string left, right, depth;     // images
  std::string left_info, right_info;  // their sensor_msgs/CameraInfo

  bool empty() const {
    return left.empty() && right.empty() && depth.empty() && left_info.empty() && right_info.empty();
  }
};

struct DatasetOptions {
  DatasetFormat format = DatasetFormat::automatic;
  std::string sequence;  // where PATH holds several; may be empty where it holds one
  FrameRange frames;     // the part to read ...
  int step = 1;          // ... and every how many of its frames
  DatasetCameras cameras = DatasetCameras::automatic;
  std::optional<int> image_bits;     // of 16-bit images, that the camera fills; none: found
  std::optional<double> frame_rate;  // Hz, used where the dataset has no times; none: then an error
  // Seconds that the two images of a frame may be apart where both have times; none: as the layout's cameras
  // are (TUM 20 ms, EuRoC 1 ms).
  std::optional<double> pair_within;
  TopicNames topics;
  std::filesystem::path
      camera;  // calibration.yaml of a recording in one file; empty: what the recording says
};

// Throws InputError where the folder is missing, of no known layout (the message lists what was looked for)
// or damaged, and UsageError where `options` ask for something that is not there.
std::unique_ptr<StereoDataset> open_dataset(const std::filesystem::path& path,
                                            const DatasetOptions& options = {});

}  // namespace penumbra::slam
