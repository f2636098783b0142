#include "apps/common/dataset_arguments.h"

#include "apps/common/finite_number.h"
#include "apps/common/parses_as.h"
#include "slam/sources/frame_range.h"

namespace penumbra::apps {

void add_dataset_arguments(CLI::App& command, DatasetArguments& arguments, const std::string& help) {
  command.add_option("dataset", arguments.folder, help)->required();
  command.add_option("--format", arguments.format, "layout of the dataset")
      ->check(CLI::IsMember({"auto", "kitti", "euroc", "published", "tum", "folder", "bag"}))
      ->capture_default_str();
  command.add_option("--frames", arguments.frames, "frames A to B-1 only")
      ->check(parses_as(slam::parse_frame_range))
      ->type_name("A:B");
  command.add_option("--step", arguments.step, "take every n-th frame, as a slower camera would")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      .add_option("--image-bits", arguments.image_bits,
                  "bits that the camera fills in 16-bit images, such as 10 or 12; found where not given")
      ->check(CLI::Range(8, 16));
}

void add_recording_arguments(CLI::App& command, DatasetArguments& arguments) {
  command.add_option("--images", arguments.images, "which images to read")
      ->check(CLI::IsMember({"auto", "grey", "colour"}))
      ->capture_default_str();
  command.add_option("--rate", arguments.frame_rate, "frames a second, where the dataset has no times")
      ->check(number_above_zero())
      ->type_name("HZ");
  command
      .add_option("--pair-within", arguments.pair_within,
                  "seconds that the two images of a frame may be apart, by their times (default: TUM 0.02, "
                  "EuRoC 0.001; bags: two cameras 0.001, depth 0.02)")
      ->check(number_above_zero())
      ->type_name("SECONDS");
  command.add_option("--sequence", arguments.sequence,
                     "which one, where the folder holds several, such as 00");
  slam::TopicNames& topics = arguments.topics;
  command
      .add_option("--left-topic", topics.left, "bags: the left camera's images, or those beside the depth")
      ->type_name("TOPIC");
  CLI::Option* right = command.add_option("--right-topic", topics.right, "bags: the right camera's images")
                           ->type_name("TOPIC");
  command.add_option("--depth-topic", topics.depth, "bags: depth that is registered to the images")
      ->excludes(right)
      ->type_name("TOPIC");
  command.add_option("--left-info-topic", topics.left_info, "bags: the left camera's sensor_msgs/CameraInfo")
      ->type_name("TOPIC");
  command.add_option("--right-info-topic", topics.right_info, "bags: the right camera's, or the depth's")
      ->type_name("TOPIC");
  command
      .add_option("--camera", arguments.camera,
                  "a calibration.yaml (docs/datasets.md): of a stream, or of a bag in place of what it says "
                  "of its cameras")
      ->check(CLI::ExistingFile)
      ->type_name("FILE");
}

slam::DatasetOptions dataset_options(const DatasetArguments& arguments) {
  slam::DatasetOptions options;
  options.format = slam::parse_dataset_format(arguments.format);
  if (!arguments.frames.empty()) options.frames = slam::parse_frame_range(arguments.frames);
  options.step = arguments.step;
  options.image_bits = arguments.image_bits;
  options.sequence = arguments.sequence;
  if (arguments.images == "grey") options.cameras = slam::DatasetCameras::grey;
  if (arguments.images == "colour") options.cameras = slam::DatasetCameras::colour;
  options.frame_rate = arguments.frame_rate;
  options.pair_within = arguments.pair_within;
  options.topics = arguments.topics;
  options.camera = arguments.camera;
  return options;
}

}  // namespace penumbra::apps
