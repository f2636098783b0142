// penumbra slam: from a stereo sequence to a trajectory and a map.

#include <fmt/core.h>

#include <memory>

#include "apps/common/commands.h"
#include "apps/common/compute_options.h"
#include "apps/common/dataset_arguments.h"
#include "apps/common/finite_number.h"
#include "apps/common/parses_as.h"
#include "apps/network/load_network.h"
#include "apps/slam/semantics_options.h"
#include "apps/slam/slam_run.h"
#include "slam/pipeline/settings_file.h"

namespace penumbra::apps {

namespace {

constexpr const char* kSlamExamples = R"(Examples:
  penumbra slam kitti --sequence 00 --out out/00
  penumbra slam kitti --sequence 06 --frames 0:50 --filter off --out out/06
  penumbra slam kitti/sequences/00 --weights maskrcnn.safetensors --out out/00
  penumbra slam out/street --masks out/street/sequences/00/instances --out out/street_slam
  penumbra slam V1_01_easy --out out/V1_01                    EuRoC: the folder with mav0/
  penumbra slam rgbd_dataset_freiburg1_xyz --out out/xyz      TUM RGB-D
  penumbra slam rgbd_dataset_freiburg1_xyz --dense --out out/xyz   and what it saw as a dense map and a plan of the floor
  penumbra slam kitti --sequence 06 --dense --grid-resolution 0.25 --out out/06   the same from pairs of images
  penumbra slam out/walking_xyz --weights yolov5n.safetensors --dynamics depth-clusters --out out/people
  penumbra slam out/walking_xyz --weights yolov5n.safetensors --dynamics static-points --out out/standing
  ffmpeg -i stereo.mp4 -f yuv4mpegpipe - | penumbra slam - --camera rig.yaml --every-frame --out out/film   images side by side
  penumbra slam /dev/video0 --camera rig.yaml --out out/live  a camera whose frames hold both images
  penumbra slam /dev/video0 --right-device /dev/video2 --camera rig.yaml --rate 30 --poses - --out out/live
  penumbra slam my_camera --step 2 --out out/mine             images and a calibration.yaml (docs/datasets.md)
  penumbra slam run.bag --out out/run                         ROS 1 bag, MCAP, rosbag2 (docs/recordings.md)
  penumbra slam run.mcap --left-topic /cam0/image_raw --right-topic /cam1/image_raw --camera rig.yaml --out out/run
  penumbra slam run.mcap --body base_link --out out/run       and the poses of the robot's base (penumbra info run.mcap lists its frames)
  penumbra slam monday --save-map yard.map --out out/monday
  penumbra slam tuesday --load-map yard.map --save-map yard.map --out out/tuesday      go on building the map
  penumbra slam wednesday --load-map yard.map --localise --out out/wednesday           only find the way in it
  penumbra slam nightly --out out/nightly --require-tracked 0.95                        exit code 1 where it lost its way
  penumbra slam --print-settings > mine.json                  every setting there is, to be changed and given with --settings
  penumbra slam kitti --sequence 00 --settings mine.json --out out/00
  penumbra slam kitti --sequence 00 --out out/00 --view       watch it: a page on http://127.0.0.1:8080/, for this machine alone
  penumbra slam kitti --sequence 00 --out out/00 --profile    and where the processor's time went

Reads KITTI (odometry, raw, 360), EuRoC, TUM-VI, TUM RGB-D, ETH3D, Bonn, OpenLORIS, Virtual KITTI 2, TartanAir, 4Seasons, ICL-NUIM and
RobotCar as they are downloaded; ROS 1 bags, MCAP, rosbag2; folders of images; streams and cameras (docs/datasets.md).

Writes into the --out folder: trajectory_kitti.txt (camera poses, one a frame; predicted where it is lost),
trajectory_tum.txt (the frames that were located), keyframes_tum.txt (the keyframes' alone), with --body: body_tum.txt (of the body where the camera was located), map.ply (points and keyframes), trajectory.svg (seen from above), run.json (settings, counts, times,
loops, errors against the ground truth), frames.json (the same frame by frame), gallery (keyframes with their features); with --dense: dense.ply, dense.pcd, plan.pgm, plan.yaml. `penumbra report` makes a page of them; with
--view the page is there while the run goes on.

Ctrl-C, `kill` and a closed terminal end the run early, with all results; a second signal within three seconds ends it at
once. Exit code 1: a recording was stopped before its end (a stream may be stopped at any time), nothing was located, or
less than --require-tracked.)";

}  // namespace

void add_slam_command(CLI::App& app) {
  const auto options = std::make_shared<SlamOptions>();
  CLI::App* command =
      app.add_subcommand("slam", "Estimate the camera's path and a map from a stereo or RGB-D sequence");
  command->footer(kSlamExamples);
  add_dataset_arguments(
      *command, options->dataset,
      "folder of the sequence; a recording: .bag, .mcap, .db3; - for a stream on standard input; or a "
      "camera: /dev/video0");
  command->add_option("--out", options->out, "folder for the results, made where it is missing")->required();
  add_recording_arguments(*command, options->dataset);
  command->add_option("--layout", options->layout, "of a stream: how the left and the right image lie in one")
      ->check(CLI::IsMember({"side-by-side", "top-bottom"}))
      ->capture_default_str();
  command
      ->add_option(
          "--right-device", options->right_device,
          "the right one of two cameras, such as /dev/video2 (default: the camera's frames hold both "
          "images, see --layout)")
      ->type_name("DEVICE");
  command->add_flag("--every-frame", options->every_frame,
                    "of a stream: it waits until a frame is done (default: the newest wins, the others are "
                    "dropped and counted)");
  command
      ->add_option(
          "--body", options->body,
          "frame of the robot, such as base_link or imu, whose poses are written, too (body_tum.txt), "
          "go to --poses, and are compared with the ground truth: by /tf_static of a recording, or by "
          "the calibration")
      ->type_name("FRAME");
  command
      ->add_option("--poses", options->poses,
                   "write the pose of each located frame (of --body) at once, as a TUM line: - for standard "
                   "output, or unix:PATH of a socket that listens")
      ->type_name("WHERE");
  command
      ->add_option(
          "--weights", options->weights,
          "Mask R-CNN, YOLOv5 or AFNET weights: what moves is left out; of YOLOv5 without masks with "
          "--dynamics depth-clusters")
      ->type_name("FILE");
  command
      ->add_option("--masks", options->masks,
                   "folder of masks as `penumbra synth` writes, instead of weights")
      ->excludes("--weights")
      ->type_name("DIR");
  add_key_option(command, options->key);
  command
      ->add_option("--classes", options->classes,
                   "file of the weights' class names, one a line (default: the weights' own, or COCO)")
      ->type_name("FILE");
  command
      ->add_option("--segmentation", options->segmentation,
                   "frames that are segmented: keyframes (and one after 0.15 s without any), every-N, all "
                   "(tracking waits), off")
      ->check(parses_as([](const std::string& text) {
        slam::SemanticsSettings semantics;
        set_segmentation(text, semantics);
      }))
      ->capture_default_str()
      ->type_name("WHICH");
  command
      ->add_option("--least-score", options->least_score,
                   "objects with a lower score are ignored (default: 0.5; of detectors without masks 0.3)")
      ->check(CLI::Range(0.0, 1.0))
      ->type_name("SCORE");
  command
      ->add_option("--dynamics", options->dynamics,
                   "an object's pixels: the detector's masks, what the depths in its box say (RGB-D; "
                   "static-points also gives back points that stand still), or all of the boxes")
      ->check(CLI::IsMember({"masks", "depth-clusters", "static-points", "boxes"}))
      ->capture_default_str();
  command
      ->add_option("--repair", options->repair,
                   "depth-clusters: how holes in boxes are filled, see docs/dynamics/depth-clusters.md")
      ->check(CLI::IsMember({"off", "paper", "border", "median", "modes"}))
      ->capture_default_str();
  command
      ->add_option("--clusters", options->clusters,
                   "depth-clusters: which depths are the object's, as the paper scores them or grown")
      ->check(CLI::IsMember({"paper", "grown"}))
      ->capture_default_str();
  command
      ->add_option("--consistency", options->consistency,
                   "depth-clusters: whether points off their epipolar lines show that an object moves")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command
      ->add_option("--foreground", options->foreground,
                   "static-points: which of the features' depths are a person's, as the paper clusters them "
                   "or adaptive, see docs/dynamics/static-points.md")
      ->check(CLI::IsMember({"paper", "adaptive"}))
      ->capture_default_str();
  command
      ->add_option("--static-points", options->static_points,
                   "which points on what can move stand still and are used: none, by the paper's thresholds, "
                   "or by the points' own uncertainty (default with --dynamics static-points: paper)")
      ->check(CLI::IsMember({"off", "paper", "adaptive"}))
      ->type_name("TEXT:{off,paper,adaptive}");
  command
      ->add_option(
          "--moving", options->moving,
          "what is left out: instances that geometry finds moving (default), or every class that can "
          "move (default with all other --dynamics than masks, and with --static-points)")
      ->check(CLI::IsMember({"geometry", "class"}))
      ->type_name("TEXT:{geometry,class}");
  command->add_option("--movers", options->movers, "find large moving things without masks, by geometry")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command
      ->add_option("--filter", options->filter,
                   "histogram mismatch filter: votes on how far features moved or, "
                   "compensated, on how far they are from where prediction and depth expect them")
      ->check(CLI::IsMember({"off", "paper", "adaptive", "compensated"}))
      ->capture_default_str();
  command
      ->add_option("--loops", options->loops,
                   "close loops when a place is seen again; recognise: only list such places in run.json")
      ->check(CLI::IsMember({"on", "recognise", "off"}))
      ->capture_default_str();
  command
      ->add_option("--constellation", options->constellation,
                   "with masks: where the same standing objects are around, fewer points prove a place")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command
      ->add_option("--self-calibration", options->self_calibration,
                   "find a constant error of the stereo disparities along with the map")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command
      ->add_option(
          "--least-sharpness", options->least_sharpness,
          "a frame below this share of the last images' sharpness (Tenengrad) leaves it to one of the next "
          "three to become a keyframe; 0: no test")
      ->check(number_from(0.0, 1.0, "a share from 0 to 1"))
      ->capture_default_str();
  command->add_option("--features", options->features, "features per image; 0 chooses by the image's size")
      ->check(CLI::Range(0, 20000))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "threads (default: all processors)")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command
      ->add_option("--segmentation-threads", options->segmentation_threads,
                   "threads of the network beside the tracker (default: all of --threads but one)")
      ->check(CLI::Range(1, 256))
      ->type_name("N");
  CLI::Option* load = command
                          ->add_option("--load-map", options->load_map,
                                       "begin with the map of an earlier run of the same camera")
                          ->type_name("FILE");
  CLI::Option* save = command->add_option("--save-map", options->save_map, "write the map there at the end")
                          ->type_name("FILE");
  command
      ->add_flag("--localise", options->localise,
                 "only find the way in the loaded map, and leave it as it is")
      ->needs(load)
      ->excludes(save);
  command
      ->add_option(
          "--checkpoint", options->checkpoint,
          "write trajectories, run.json and map every so many seconds, for a power cut; 0: only at the end")
      ->check(number_from(0.0, 86400.0, "seconds from 0 to 86400"))
      ->capture_default_str()
      ->type_name("SECONDS");
  command->add_flag("--strict", options->strict,
                    "an image that cannot be read ends the run (default: it costs its frame)");
  command
      ->add_option("--require-tracked", options->require_tracked,
                   "share of the frames, from 0 to 1; where fewer are located the exit code is 1")
      ->check(number_from(0.0, 1.0, "a share from 0 to 1"))
      ->type_name("SHARE");
  command
      ->add_option("--settings", options->settings,
                   "file with settings of the pipeline (docs/slam/settings.md); options given beside it win")
      ->check(CLI::ExistingFile)
      ->type_name("FILE");
  CLI::Option* dense = command->add_flag(
      "--dense", options->dense,
      "write what stands as coloured voxels with classes (dense.ply, dense.pcd) and as a plan of the floor "
      "(plan.pgm, plan.yaml) for robots: from the depth images, or from the pairs by semi-global matching");
  command
      ->add_option("--grid-resolution", options->grid_resolution,
                   "side of the plan's cells; of pairs the voxels are half of it (default: 0.05 m, of pairs "
                   "what depth tells apart at 24 baselines)")
      ->check(number_from(0.001, 100.0, "metres from 0.001 to 100"))
      ->needs(dense)
      ->type_name("METRES");
  add_isa_option(command);
  command->add_flag("--deterministic", options->deterministic,
                    "mapping in line with tracking: results repeat bit for bit");
  command->add_flag(
      "--profile", options->profile,
      "show where the processor's time went: each thread's stages, milliseconds a frame (also in "
      "run.json)");
  command->add_flag(std::string("--view{") + kAnyViewPort + "}", options->view,
                    "show the run in a browser on this machine while it goes on, --view=PORT on a port of "
                    "its own (default: "
                    "the first free one from 8080)");
  const auto note_given = [options, command] {
    for (const CLI::Option* option : command->get_options()) {
      if (option->count() > 0) options->given.insert(option->get_name());
    }
  };
  command->add_flag_callback(
      "--print-settings",
      [options, note_given] {
        note_given();
        fmt::print("{}", slam::settings_text(make_settings(*options)));
        throw CLI::Success();
      },
      "print every setting, with those of --settings and of the other options, as such a file");
  command->callback([options, note_given] {
    note_given();
    run_slam(*options);
  });
}

}  // namespace penumbra::apps
