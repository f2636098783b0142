// A run of `penumbra slam`: opens the recording, feeds the pipeline frame by frame, and keeps what it finds
// whatever happens: signals, torn images, a full disk.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "apps/common/dataset_arguments.h"
#include "nn/base/parallel.h"
#include "slam/pipeline/slam.h"

namespace penumbra::apps {

// --view without a port.
inline constexpr const char* kAnyViewPort = "auto";

struct SlamOptions {
  DatasetArguments dataset;
  std::string settings;         // file of settings; empty: none
  std::set<std::string> given;  // options that the command line has, such as "--filter"
  std::string out, weights, key, classes, masks, save_map, load_map;
  std::string filter = "adaptive", loops = "on", constellation = "on", self_calibration = "on";
  std::string segmentation = "keyframes", dynamics = "masks", moving = "geometry", movers = "on";
  std::string repair = "modes", clusters = "grown", consistency = "on";  // of --dynamics depth-clusters
  std::string foreground = "paper", static_points = "off";               // of --dynamics static-points
  std::string view;                                                      // port, or kAnyViewPort; empty: none
  std::string layout = "side-by-side";  // of a stream: how two images lie in one
  std::string right_device;             // of two cameras; empty: the one has both images
  bool every_frame = false;             // of a stream: it waits, and no frame is dropped
  std::string body;                     // frame whose poses are written, too, where it is given
  std::string poses;                    // where poses go as they are found; empty: nowhere
  std::optional<double> least_score;
  double least_sharpness = 0.0;
  double grid_resolution = 0.0;  // metres; 0: by the camera
  bool deterministic = false, localise = false, dense = false, profile = false;
  int features = 0, threads = thread_count(), segmentation_threads = 0;
  double checkpoint = 60.0;      // seconds between two; 0: none
  bool strict = false;           // an image that cannot be read ends the run
  double require_tracked = 0.0;  // share of the frames, below which the run has failed
};

// The settings of the file, if one is given, and those of the command line above them. Throws InputError for
// a file that read_settings refuses.
slam::SlamSettings make_settings(const SlamOptions& options);

// Throws UsageError for options that do not fit together; InputError and Error for what cannot be read or
// written, where a recording was stopped, and where too few frames were located. All results that there are
// are written before.
void run_slam(const SlamOptions& options);

}  // namespace penumbra::apps
