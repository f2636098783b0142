// Keeps of some frames what the dense map is made of, and makes that map: of what stands, at the poses that
// the frames have by then, with the classes that the segmenter has found by then (slam/map/dense/fusion.h).
// Depth is what the camera measured, or what the pair of images shows (stereo_view.h); all else is the same.
//
//   DenseMapper dense(settings.dense);
//   for each frame:  result = slam.process(images);
//                    if (dense.add(camera, images, result)) record.keep_masks_of(result.index);
//                    record.add(result);
//   record.finish();
//   write(dense.build(record));
//
// A frame counts where the segmenter is shown it: keyframes and some between them. One that was taken nearer
// than `least_metres` and `least_degrees` to the last one that is kept brings nothing new and is left out.
// From where the camera stands some are kept, one a second: people come and go before it. Memory: 460 kB a
// view of 640 x 480 with a step of 2, 175 kB of a pair of 1241 x 376; voxel_grid.h says what a voxel takes.
// The thread that calls Slam::process() uses it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "slam/map/dense/fusion.h"
#include "slam/map/dense/occupancy_grid.h"
#include "slam/pipeline/recorder.h"
#include "slam/pipeline/stereo_view.h"

namespace penumbra::slam {

struct DenseMap {
  VoxelGrid voxels;
  std::vector<std::string> classes;   // by number; 0: none
  std::optional<FloorPlane> floor;    // none where none was found
  std::optional<OccupancyGrid> plan;  // where there is a floor
  double floor_from =
      0.0;  // metres ahead of the cameras from where on they see it (median); 0: never, or no floor
  int views = 0;
  std::size_t bytes = 0;  // of views and voxels
};

class DenseMapper {
 public:
  // `settings`: with what follows from the sensor.
  explicit DenseMapper(const DenseSettings& settings)
      : settings_(settings), stereo_(settings.stereo, settings.fusion.farthest) {}

  // Returns whether it keeps the frame.
  bool add(const StereoCamera& camera, const StereoImages& images, const FrameResult& result);
  // The map as it is now. Takes the map's lock shared.
  DenseMap build(const Recorder& record);
  int views() const { return static_cast<int>(kept_.size()); }
  // Of finding depth in pairs of images, so far.
  StageTimer take_times() { return std::exchange(timer_, StageTimer()); }

 private:
  struct Kept {
    int frame = 0;
    FramePlace place;
    DenseView view;
  };
  class ClassNumbers;
  bool brings_something(const FrameResult& result);
  void label(Kept& kept, const Recorder& record, const ClassNumbers& numbers) const;
  void mark_displaced(const Recorder& record, const std::vector<PosedView>& views);
  void leave_out_unsegmented(const Recorder& record, const std::vector<PosedView>& views);

  const DenseSettings settings_;
  StereoViewMaker stereo_;
  StageTimer timer_;
  std::vector<Kept> kept_;
  SE3 last_T_wc_;  // of the last that is kept, as it was located then
  double last_time_ = 0.0;
  int standing_ = 0;  // that are kept from where the camera is
};

}  // namespace penumbra::slam
