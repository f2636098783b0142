// What the readers of all layouts end in: a list of frames with their images, where these are read from, and
// how to make rectified ones of them.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "slam/geometry/rectification.h"
#include "slam/sources/image_reader.h"
#include "slam/sources/open_dataset.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

struct RecordedFrame {
  int index = 0;             // frame number in the sequence
  double timestamp = 0.0;    // seconds
  ImageKey left, second;     // the second image: right, or depth
  double depth_delay = 0.0;  // StereoImages::depth_delay
};

struct Recording {
  std::string name;   // for logs and reports
  std::string place;  // folder, for messages
  Sensor sensor = Sensor::stereo;
  bool side_by_side = false;          // `left` and `second` are one image: its left and its right half
  std::vector<RecordedFrame> frames;  // all of the sequence
  std::shared_ptr<const ImageReader> images = file_images();
  StereoCamera camera;  // of the rectified images; width 0: as the first image
  Remap left, right;    // to rectified images
  nn::ImageColour colour = nn::ImageColour::grey;
  Trajectory ground_truth;          // T_wc of the left rectified camera, at any times; empty: none
  std::vector<Mounting> mountings;  // of the left rectified camera
  std::vector<std::string> notes;
};

// The frames that `options` choose. Ground truth: for each frame the pose nearest in time, if one is within
// 0.01 s. Reads the first frame, whose images give the size where the calibration does not. Of frames with
// one time the first is kept. Adds notes: repeated times, times that jump (frames that were dropped), the
// bits of 16 that images use (slam/sources/image_levels.h), EXIF data that say the camera was turned, rows
// of left and right images that disagree (slam/sources/row_check.h), a camera that does not fit the images
// (slam/sources/camera_check.h). Throws InputError for times that do not
// increase, images of another size, no frames.
std::unique_ptr<StereoDataset> open_recording(Recording recording, const DatasetOptions& options);

// Says that the times of `source` are used and --rate, if given, is not.
void note_unused_rate(std::optional<double> rate, const std::filesystem::path& source,
                      std::vector<std::string>& notes);

// Whether to read colour: as the options say, or `otherwise`.
nn::ImageColour colour_of(DatasetCameras cameras, nn::ImageColour otherwise);

}  // namespace penumbra::slam
