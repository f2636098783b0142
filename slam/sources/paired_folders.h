// Two folders of images, left and right or colour and depth, and what a data set tells of them: what most
// layouts come to. Images of one name belong together (slam/sources/image_pairs.h).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nn/image/bayer.h"
#include "slam/geometry/trajectory.h"
#include "slam/sources/calibration/calibration.h"
#include "slam/sources/open_dataset.h"

namespace penumbra::slam {

// Lines of a file, one for every left image, for every name in either folder, or for every pair.
template <typename T>
struct ImageLines {
  std::filesystem::path file;  // for messages; empty: there is none
  std::vector<T> lines;
};

struct PairedFolders {
  std::string name;                     // for reports
  std::filesystem::path place;          // of the recording, for messages
  std::filesystem::path first, second;  // folders of images
  bool side_by_side = false;            // one folder, of images that show both
  CameraFile camera;
  std::optional<RecordedCamera> made;  // in place of what `camera` makes, where tables undo the lenses
  std::optional<BayerPattern> mosaic;  // of the filters before the pixels of grey files
  std::optional<Size> made_for;  // images of another size are read with a warning: `camera` may not be theirs
  ImageLines<double> times;      // seconds; without: in the names, or from the rate
  std::optional<double> rate;    // Hz, of the layout, where neither times nor the user tell
  ImageLines<SE3> poses;         // T_wc of the raw left camera
  Trajectory truth;              // the same with times
  Trajectory numbered_truth;     // or with the numbers at the end of the images' names as times
  std::vector<std::string> notes;
};

// Throws InputError naming the file and what is wrong with it: no pairs, lines for other images, no times.
std::unique_ptr<StereoDataset> open_paired_folders(PairedFolders folders, const DatasetOptions& options);

}  // namespace penumbra::slam
