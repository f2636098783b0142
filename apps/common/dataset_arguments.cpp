#include "apps/common/dataset_arguments.h"

#include "slam/sources/frame_range.h"

namespace penumbra::apps {

void add_dataset_arguments(CLI::App& command, DatasetArguments& arguments, const std::string& help) {
  command.add_option("dataset", arguments.folder, help)->required();
  command.add_option("--format", arguments.format, "layout of the dataset")
      ->check(CLI::IsMember({"auto", "kitti", "euroc", "tum", "folder"}))
      ->capture_default_str();
  command.add_option("--frames", arguments.frames, "A:B, frames A to B-1 only");
  command.add_option("--step", arguments.step, "take every n-th frame, as a slower camera would")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      .add_option("--image-bits", arguments.image_bits,
                  "bits that the camera fills in 16-bit images, such as 10 or 12; found where not given")
      ->check(CLI::Range(8, 16));
}

slam::DatasetOptions dataset_options(const DatasetArguments& arguments) {
  slam::DatasetOptions options;
  options.format = slam::parse_dataset_format(arguments.format);
  if (!arguments.frames.empty()) options.frames = slam::parse_frame_range(arguments.frames);
  options.step = arguments.step;
  options.image_bits = arguments.image_bits;
  return options;
}

}  // namespace penumbra::apps
