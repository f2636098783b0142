// penumbra synth: renders a drive through the synthetic street.
#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <memory>

#include "apps/commands.h"
#include "apps/progress_bar.h"
#include "nn/base/error.h"
#include "slam/datasets/synthetic/street_sequence.h"

namespace penumbra::apps {

namespace {

namespace synthetic = slam::synthetic;

struct SynthOptions {
  synthetic::SequenceSettings sequence;
  std::string size = "620x188";
  std::filesystem::path out;
  bool overwrite = false;
};

cv::Size parse_size(const std::string& text) {
  int width = 0, height = 0, used = 0;
  // Up to five digits each, so that no number overflows.
  if (std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &used) != 2 ||
      used != static_cast<int>(text.size())) {
    throw UsageError(fmt::format("--size: expected WIDTHxHEIGHT such as 620x188, found '{}'", text));
  }
  return {width, height};
}

void run_synth(SynthOptions options) {
  options.sequence.size = parse_size(options.size);
  synthetic::StreetSequence sequence(options.sequence);
  ProgressBar bar("Rendering", sequence.size());
  synthetic::write_kitti_layout(sequence, options.out, options.overwrite,
                                [&](int done) { bar.update(done); });
  fmt::print("{} stereo pairs of {}x{} in {} ({:.1f} pairs/s)\n", sequence.size(),
             options.sequence.size.width, options.sequence.size.height, options.out.string(), bar.rate());
}

}  // namespace

void add_synth_command(CLI::App& app) {
  auto options = std::make_shared<SynthOptions>();
  CLI::App* command =
      app.add_subcommand("synth", "Make a synthetic stereo drive with ground truth (KITTI layout)");
  synthetic::SequenceSettings& sequence = options->sequence;
  command->add_option("--out", options->out, "Folder to write; new or empty")->required()->type_name("DIR");
  command->add_option("--preset", sequence.preset, "How much traffic: easy, street, crowded")
      ->capture_default_str()
      ->type_name("NAME");
  command->add_option("--path", sequence.path, "Where to drive: block, straight, or a KITTI pose file")
      ->capture_default_str()
      ->type_name("PATH");
  command
      ->add_option("--frames", sequence.frames, "Frames at 10 per second; default 60, or all of a pose file")
      ->check(CLI::Range(1, 20000))
      ->type_name("N");
  command->add_option("--size", options->size, "Image size in pixels")
      ->capture_default_str()
      ->type_name("WxH");
  command->add_option("--seed", sequence.seed, "Another seed makes another street")
      ->capture_default_str()
      ->type_name("N");
  command->add_flag("--colour", sequence.colour, "Write colour images as well (image_2, image_3)");
  command->add_flag("--depth", sequence.depth, "Write depth of the left image (16-bit PNG, 256 = 1 m)");
  command->add_flag("--annotations", sequence.annotations,
                    "Write annotations/instances.json: COCO instances with amodal masks and occlusion");
  command->add_flag("--overwrite", options->overwrite, "Replace the sequence in a folder that is not empty");
  command->footer(
      "Examples:\n"
      "  penumbra synth --out out/street\n"
      "  penumbra synth --frames 300 --preset crowded --seed 7 --colour --out out/crowded\n"
      "  penumbra synth --path kitti/poses/07.txt --size 1241x376 --out out/07");
  command->callback([options] { run_synth(*options); });
}

}  // namespace penumbra::apps
