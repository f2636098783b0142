// penumbra brain: the brain-inspired SLAM, from self-motion and images to a cognitive map.
#include <memory>

#include "apps/brain/brain_run.h"
#include "apps/brain/landmark_finder.h"
#include "apps/common/commands.h"
#include "apps/common/compute_options.h"
#include "apps/common/finite_number.h"
#include "nn/base/error.h"

namespace penumbra::apps {

namespace {

constexpr const char* kBrainExamples = R"(Examples:
  penumbra brain out/street --out out/brain
  penumbra brain out/street --odometry wheels.txt --save-map yard.brain --out out/monday
  penumbra brain out/street --odometry wheels.txt --load-map yard.brain --out out/tuesday
  penumbra brain out/street --noise rough --seed 3 --out out/rough
  penumbra brain out/street --noise rough --seed 3 --templates ratslam --out out/ratslam
  penumbra report out/brain

Writes into the --out folder: trajectory_kitti.txt and trajectory_tum.txt (a pose a frame, by the settled map),
cognitive_map.json (nodes and links), frames.json, run.json (counts, times, loops, errors against the ground truth), and
pictures: trajectory.svg, believed.svg (as the robot believed at the time), cognitive_map.svg, error.svg (over time, with
the moments of recall), places.png (the place cells' activity). The robot's motion is that of visual odometry, of a
file, or the true one made worse. It moves in a plane. docs/brain/README.md has the chapters.)";

}  // namespace

void add_brain_command(CLI::App& app) {
  const auto options = std::make_shared<BrainOptions>();
  CLI::App* command = app.add_subcommand(
      "brain", "Find the way as brains do: grid cells, places known again, a cognitive map");
  command->footer(kBrainExamples);
  add_dataset_arguments(*command, options->dataset, "folder of the sequence");
  command->get_option("dataset")->required(false);
  command->add_option("--out", options->out, "folder for the results, made where it is missing")
      ->type_name("DIR");
  add_recording_arguments(*command, options->dataset);
  CLI::Option* odometry =
      command
          ->add_option(
              "--odometry", options->odometry,
              "file of wheel odometry, a line a sample: time (s), speed (m/s), turn rate (rad/s, to the "
              "left)")
          ->type_name("FILE");
  command
      ->add_option("--noise", options->noise,
                   "take the true motion, made worse: none, noisy (2 % of the way, a gyroscope that drifts, "
                   "slips) or rough")
      ->excludes(odometry)
      ->type_name("NAME");
  command
      ->add_option("--camera-yaw", options->camera_yaw,
                   "degrees that the camera looks to the left of where the robot drives (default: 0; with "
                   "--noise: as the true path says)")
      ->check(number_from(-180.0, 180.0, "degrees from -180 to 180"))
      ->type_name("DEG");
  command
      ->add_option("--camera-pitch", options->camera_pitch, "degrees that it looks down (default: likewise)")
      ->check(number_from(-80.0, 80.0, "degrees from -80 to 80"))
      ->type_name("DEG");
  command->add_option("--seed", options->seed, "of that noise")->capture_default_str();
  command
      ->add_option("--templates", options->templates,
                   "what is kept of a view: landmarks with their interest, intensity profiles, or ratslam: "
                   "profiles without any geometry, as RatSLAM does")
      ->check(CLI::IsMember({"landmarks", "intensity", "ratslam"}))
      ->capture_default_str();
  add_interest_weights_option(command, options->weights);
  command
      ->add_option("--interest", options->interest,
                   "off: every landmark counts the same, however many of its kind there are")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  command
      ->add_option("--sight", options->sight,
                   "steps from keyframe to keyframe by sight, or only what they teach about the felt ones")
      ->check(CLI::IsMember({"on", "calibrate", "off"}))
      ->capture_default_str();
  command
      ->add_option("--relaxation", options->relaxation,
                   "how the map settles: as the paper prints it, mean, settled")
      ->check(CLI::IsMember({"paper", "mean", "settled"}))
      ->capture_default_str();
  command
      ->add_option("--least-sharpness", options->least_sharpness,
                   "a keyframe below this share of the last ones' sharpness leaves its place to the frame "
                   "before; 0: no test")
      ->check(number_from(0.0, 1.0, "a share from 0 to 1"))
      ->capture_default_str();
  add_threads_option(command);
  add_isa_option(command);
  command->add_option("--save-map", options->save_map, "write the cognitive map there at the end")
      ->type_name("FILE");
  command->add_option("--load-map", options->load_map, "begin with the cognitive map of an earlier run")
      ->type_name("FILE");
  add_landmarks_command(*command);
  add_train_grid_command(*command);
  command->callback([options, command] {
    if (!command->get_subcommands().empty()) return;
    if (options->dataset.folder.empty())
      throw UsageError("brain: expected the folder of a sequence, found none");
    if (options->out.empty()) throw UsageError("brain: --out is missing: the folder for the results");
    run_brain(*options);
  });
}

}  // namespace penumbra::apps
