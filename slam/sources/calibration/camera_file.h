// calibration.yaml: Penumbra's own description of a camera, for TUM folders and folders of any images. The
// keys are listed in docs/datasets.md.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "slam/geometry/mounting.h"
#include "slam/geometry/rectification.h"
#include "slam/geometry/sensor.h"
#include "slam/sources/calibration/yaml_file.h"

namespace penumbra::slam {

struct CameraFile {
  Sensor sensor = Sensor::stereo;
  bool rectified = true;   // stereo: both images are those of one pinhole camera, `left`
  LensCamera left, right;  // `right` where the pair is not rectified; size 0 where the file does not give it
  SE3 T_right_left;        // likewise
  double baseline = 0.0;   // metres, of rectified pairs and RGB-D cameras
  double depth_factor = 5000.0;      // levels a metre (RGB-D)
  std::optional<bool> colour;        // what the images are to be read as
  std::optional<double> frame_rate;  // Hz
  std::vector<Mounting> mountings;   // of the left camera as it is, not rectified
  std::string place;                 // for messages
  std::vector<std::string> notes;    // what was taken because the file does not say it
};

// Of RGB-D cameras without a `baseline`: that of the first Kinect and most others.
inline constexpr double kNominalBaseline = 0.075;  // metres

// Throws InputError (file:line) for keys that are missing or numbers that no camera has.
CameraFile read_own_camera_file(const std::filesystem::path& path);

// Takes `left` for the colour camera of an RGB-D camera, as its file, which describes one camera, may mean;
// what the file does not say is noted.
void take_for_rgbd(CameraFile& file, const std::string& place);

// Whether the size of the images must be known, to rectify them, and the file does not say it, as OpenCV's.
inline bool lacks_size(const CameraFile& file) { return !file.rectified && file.left.width == 0; }
// Takes that of the images where the file does not say it; of raw cameras that is noted.
void take_size(const Size& image, CameraFile& file);

// What a recording needs to know about it; an undistorted or rectified pair where the images are not.
// Throws InputError as rectify_stereo and undistort do.
struct RecordedCamera {
  StereoCamera camera;  // of the rectified images; size 0 where the file does not give it
  Remap left, right;
  Eigen::Matrix3d R_rectified_left = Eigen::Matrix3d::Identity();
  std::vector<Mounting> mountings;  // of the left rectified camera

  // Adds where the left camera stands as it is, not rectified.
  void stands(const Mounting& of_left);
};
RecordedCamera make_camera(const CameraFile& file);

// A 3 x 4 or 4 x 4 matrix, row by row. Throws InputError naming `place` where it is no rigid motion.
SE3 rigid_motion(const std::vector<double>& rows, const std::string& place);
SE3 rigid_motion(const std::vector<double>& rotation, const std::vector<double>& translation,
                 const std::string& place);
// T_right_left of two raw cameras by what rectifies them: the rotation of each into the rectified frame, and
// how far the right one is along the rows, metres.
SE3 motion_of_rectified(const Eigen::Matrix3d& R_left, const Eigen::Matrix3d& R_right, double baseline);
SE3 read_transform(const YamlFile& yaml, const std::string& key);

}  // namespace penumbra::slam
