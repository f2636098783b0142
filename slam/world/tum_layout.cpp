// Writes an RGB-D sequence as the TUM RGB-D benchmark lays its own out.
#include <algorithm>
#include <map>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/parallel.h"
#include "slam/geometry/trajectory_io.h"
#include "slam/world/coco_annotations.h"
#include "slam/world/ground_truth_images.h"
#include "slam/world/landmark_images.h"
#include "slam/world/layouts.h"
#include "slam/world/plan_truth.h"
#include "slam/world/sequence_files.h"

namespace penumbra::slam::synthetic {

namespace {

namespace fs = std::filesystem;

constexpr float kLevelsAMetre = 5000.0F;  // as in the benchmark

}  // namespace

void write_tum_layout(Sequence& sequence, const fs::path& folder, bool overwrite,
                      const std::function<void(int)>& progress) {
  const Recording& recording = sequence.recording();
  const float factor = recording.depth_camera ? recording.depth_camera->levels_a_metre : kLevelsAMetre;
  SequenceFrame frame;
  const ThingNumbers things(sequence.world());
  const FrameOutput outputs[] = {
      {"rgb", true, [&] { return frame.left_bgr; }},
      {"depth", true, [&] { return encode_sensed_depth(frame.sensed_depth, factor); }},
      {"instances", true, [&] { return frame.left.instance; }},
      {"depth_clean", recording.depth, [&] { return encode_depth(frame.left.depth, factor); }},
      {"flow", recording.flow, [&] { return encode_flow(frame.flow); }, true},
      {"landmarks", recording.landmarks, [&] { return landmark_image(things, frame.left); }},
  };
  std::vector<fs::path> earlier{"amodal", "landmarks.json", "plan.pgm", "plan.yaml",
                                "annotations/instances.json"};
  for (const FrameOutput& output : outputs) earlier.emplace_back(output.name);
  prepare_folder(folder, overwrite, earlier);
  make_folders(folder, outputs);
  if (recording.annotations) make_folder(folder / "annotations");
  const StereoCamera& camera = sequence.camera();
  nn::write_file(
      folder / "calibration.yaml",
      fmt::format("# A pinhole camera without distortion; depth images: level / depth_factor = metres, "
                  "0 = no depth.\nwidth: {}\nheight: {}\nfx: {:.6f}\nfy: {:.6f}\ncx: {:.6f}\n"
                  "cy: {:.6f}\ndepth_factor: {}\nrate: {}\n",
                  camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, factor,
                  sequence.rate()));
  write_instance_list(folder / "instances.json", sequence.world());
  write_occupancy(folder / "plan", true_plan(sequence.world(), sequence.poses()));
  if (recording.landmarks) nn::write_file(folder / "landmarks.json", things.list());

  Trajectory from_first = sequence.poses();
  const SE3 first_from_world = from_first.front().T_wc.inverse();
  for (TimedPose& pose : from_first) pose.T_wc = first_from_world * pose.T_wc;
  write_tum_trajectory(folder / "groundtruth.txt", from_first);

  std::map<std::string, std::string> lists{{"rgb", ""}, {"depth", ""}};
  if (recording.depth) lists["depth_clean"] = "";
  for (auto& [name, list] : lists) list = "# timestamp filename\n";
  CocoWriter annotations(sequence.image_size(), sequence.world().catalogue);
  ImageWriter images(std::max(1, thread_count() / 2));
  for (int i = 0; i < sequence.size(); ++i) {
    sequence.render(i, frame);
    const std::string time = fmt::format("{:.6f}", from_first[static_cast<std::size_t>(i)].timestamp);
    images.write(folder, outputs, time + ".png", i + 1 == sequence.size());
    if (recording.amodal)
      write_whole_masks(images, folder / "amodal" / time, frame.instances, sequence.image_size());
    if (recording.annotations) annotations.add("rgb/" + time + ".png", frame.instances);
    const double sensed =
        from_first[static_cast<std::size_t>(i)].timestamp + static_cast<double>(recording.depth_delay);
    for (auto& [name, list] : lists) {
      list +=
          fmt::format("{} {}/{}.png\n", name == "depth" ? fmt::format("{:.6f}", sensed) : time, name, time);
    }
    if (progress) progress(i + 1);
  }
  images.finish();
  if (recording.annotations) nn::write_file(folder / "annotations/instances.json", annotations.finish());
  for (const auto& [name, list] : lists) nn::write_file(folder / (name + ".txt"), list);
}

}  // namespace penumbra::slam::synthetic
