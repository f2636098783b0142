// Writes a stereo sequence as KITTI odometry lays its own out.
#include <algorithm>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/parallel.h"
#include "slam/world/coco_annotations.h"
#include "slam/world/ground_truth_images.h"
#include "slam/world/landmark_images.h"
#include "slam/world/layouts.h"
#include "slam/world/plan_truth.h"
#include "slam/world/sequence_files.h"

namespace penumbra::slam::synthetic {

namespace {

namespace fs = std::filesystem;

std::string row_of(const SE3& pose) {
  std::string row;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) row += fmt::format("{:.9e} ", pose.rotation(r, c));
    row += fmt::format("{:.9e}{}", pose.translation[r], r < 2 ? " " : "\n");
  }
  return row;
}

void write_calibration(const fs::path& path, const StereoCamera& camera) {
  std::string text;
  for (int number = 0; number < 4; ++number) {
    // The colour cameras stand where the grey ones do.
    const double offset = number % 2 == 0 ? 0.0 : -camera.fx * camera.baseline;
    text += fmt::format("P{}: {:.12e} 0 {:.12e} {:.12e} 0 {:.12e} {:.12e} 0 0 0 1 0\n", number, camera.fx,
                        camera.cx, offset, camera.fy, camera.cy);
  }
  nn::write_file(path, text);
}

void write_trajectory(const fs::path& poses_path, const fs::path& times_path, const Trajectory& poses) {
  std::string rows, times;
  const SE3 first_from_world = poses.front().T_wc.inverse();
  for (const TimedPose& pose : poses) {
    rows += row_of(first_from_world * pose.T_wc);
    times += fmt::format("{:.6e}\n", pose.timestamp);
  }
  nn::write_file(poses_path, rows);
  nn::write_file(times_path, times);
}

}  // namespace

void write_kitti_layout(Sequence& sequence, const fs::path& folder, bool overwrite,
                        const std::function<void(int)>& progress) {
  const Recording& recording = sequence.recording();
  const fs::path root = folder / "sequences/00";
  std::vector<fs::path> earlier{"annotations/instances.json"};
  for (const char* name : {"image_0", "image_1", "image_2", "image_3", "instances", "depth", "disparity",
                           "flow", "amodal", "landmarks", "landmarks.json", "plan.pgm", "plan.yaml"}) {
    earlier.push_back(fs::path("sequences/00") / name);
  }
  prepare_folder(folder, overwrite, earlier);

  SequenceFrame frame;
  const ThingNumbers things(sequence.world());
  const FrameOutput outputs[] = {
      {"image_0", true, [&] { return frame.left_grey; }},
      {"image_1", true, [&] { return frame.right_grey; }},
      {"image_2", recording.colour, [&] { return frame.left_bgr; }},
      {"image_3", recording.colour, [&] { return frame.right_bgr; }},
      {"instances", true, [&] { return frame.left.instance; }},
      {"depth", recording.depth, [&] { return encode_depth(frame.left.depth, 256.0F); }},
      {"disparity", recording.disparity,
       [&] { return encode_disparity(frame.left.depth, sequence.camera()); }},
      {"flow", recording.flow, [&] { return encode_flow(frame.flow); }, true},
      {"landmarks", recording.landmarks, [&] { return landmark_image(things, frame.left); }},
  };
  make_folders(root, outputs);
  make_folder(folder / "poses");
  if (recording.annotations) make_folder(folder / "annotations");
  nn::write_file(root / "name.txt", sequence.name() + "\n");
  write_calibration(root / "calib.txt", sequence.camera());
  write_trajectory(folder / "poses/00.txt", root / "times.txt", sequence.poses());
  write_instance_list(root / "instances.json", sequence.world());
  write_occupancy(root / "plan", true_plan(sequence.world(), sequence.poses()));
  if (recording.landmarks) nn::write_file(root / "landmarks.json", things.list());

  CocoWriter annotations(sequence.image_size(), sequence.world().catalogue);
  ImageWriter images(std::max(1, thread_count() / 2));
  for (int i = 0; i < sequence.size(); ++i) {
    sequence.render(i, frame);
    const std::string name = fmt::format("{:06d}.png", i);
    images.write(root, outputs, name, i + 1 == sequence.size());
    if (recording.amodal) {
      write_whole_masks(images, root / "amodal" / fmt::format("{:06d}", i), frame.instances,
                        sequence.image_size());
    }
    if (recording.annotations) {
      annotations.add(fmt::format("sequences/00/{}/{}", recording.colour ? "image_2" : "image_0", name),
                      frame.instances);
    }
    if (progress) progress(i + 1);
  }
  images.finish();
  if (recording.annotations) nn::write_file(folder / "annotations/instances.json", annotations.finish());
}

}  // namespace penumbra::slam::synthetic
