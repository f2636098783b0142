// Writes an RGB-D drive as the TUM RGB-D benchmark lays its own out.
#include <omp.h>

#include <algorithm>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/world/coco_annotations.h"
#include "slam/world/ground_truth_images.h"
#include "slam/world/sequence_files.h"
#include "slam/world/street_sequence.h"

namespace penumbra::slam::synthetic {

void write_tum_layout(StreetSequence& sequence, const std::filesystem::path& folder, bool overwrite,
                      const std::function<void(int)>& progress) {
  constexpr float kDepthFactor = 5000.0F;  // levels a metre, as in the benchmark
  prepare_folder(folder, overwrite, {"rgb", "depth", "instances", "annotations/instances.json"});
  if (sequence.settings().annotations) make_folder(folder / "annotations");
  for (const char* name : {"rgb", "depth", "instances"}) make_folder(folder / name);
  const StereoCamera& camera = sequence.camera();
  nn::write_file(
      folder / "calibration.yaml",
      fmt::format("# A pinhole camera without distortion; depth images: level / depth_factor = metres, "
                  "0 = no depth.\nwidth: {}\nheight: {}\nfx: {:.6f}\nfy: {:.6f}\ncx: {:.6f}\n"
                  "cy: {:.6f}\ndepth_factor: {}\nrate: {}\n",
                  camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, kDepthFactor,
                  kFrameRate));
  write_instance_list(folder / "instances.json", sequence.world());

  Trajectory from_first = sequence.poses();
  const SE3 first_from_world = from_first.front().T_wc.inverse();
  for (TimedPose& pose : from_first) pose.T_wc = first_from_world * pose.T_wc;
  write_tum_trajectory(folder / "groundtruth.txt", from_first);

  std::string colour_list = "# timestamp filename\n", depth_list = colour_list;
  StreetFrame frame;
  CocoWriter annotations(sequence.settings().size);
  ImageWriter images(std::max(1, omp_get_max_threads() / 2));
  for (int i = 0; i < sequence.size(); ++i) {
    sequence.render(i, frame);
    const std::string time = fmt::format("{:.6f}", from_first[static_cast<std::size_t>(i)].timestamp);
    images.write(folder / "rgb" / (time + ".png"), frame.left_bgr);
    images.write(folder / "depth" / (time + ".png"), encode_depth(frame.sensed_depth, kDepthFactor));
    images.write(folder / "instances" / (time + ".png"), frame.left.instance);
    if (sequence.settings().annotations) annotations.add("rgb/" + time + ".png", frame.instances);
    colour_list += fmt::format("{0} rgb/{0}.png\n", time);
    depth_list += fmt::format("{0} depth/{0}.png\n", time);
    if (progress) progress(i + 1);
  }
  images.finish();
  if (sequence.settings().annotations)
    nn::write_file(folder / "annotations/instances.json", annotations.finish());
  nn::write_file(folder / "rgb.txt", colour_list);
  nn::write_file(folder / "depth.txt", depth_list);
}

}  // namespace penumbra::slam::synthetic
