// penumbra synth: renders a drive through the synthetic street.
#include <fmt/core.h>

#include <cstdio>
#include <memory>
#include <optional>

#include "apps/common/commands.h"
#include "apps/common/image_size.h"
#include "apps/common/progress_bar.h"
#include "nn/base/error.h"
#include "slam/world/street_sequence.h"

namespace penumbra::apps {

namespace {

namespace synthetic = slam::synthetic;

struct SynthOptions {
  synthetic::SequenceSettings sequence;
  std::string preset = "street", sensor = "stereo";
  std::string size;  // empty: as the sensor's kind usually has
  std::filesystem::path out;
  bool overwrite = false;
  // What replaces the preset's values.
  std::optional<float> parked, traffic, moving, texture, exposure_change, noise, shutter, glare;
  std::optional<std::string> light, lorry;
};

Size parse_size(const std::string& text) {
  const std::optional<Size> size = parse_image_size(text);
  if (!size) throw UsageError(fmt::format("--size: expected WIDTHxHEIGHT such as 620x188, found '{}'", text));
  return *size;
}

synthetic::LorryAhead parse_gaps(const std::string& text) {
  float nearest = 0.0F, farthest = 0.0F;
  int used = 0;
  if (std::sscanf(text.c_str(), "%8f,%8f%n", &nearest, &farthest, &used) != 2 ||
      used != static_cast<int>(text.size())) {
    throw UsageError(
        fmt::format("--lorry: expected NEAREST,FARTHEST in metres such as 6,12, found '{}'", text));
  }
  return {.nearest = nearest, .farthest = farthest};
}

synthetic::StreetSettings street_of(const SynthOptions& options) {
  synthetic::StreetSettings street = synthetic::street_preset(options.preset);
  street.parked_cars = options.parked.value_or(street.parked_cars);
  street.traffic = options.traffic.value_or(street.traffic);
  if (options.moving) street.moving = options.moving;
  if (options.lorry) {
    street.lorry = parse_gaps(*options.lorry);
    street.car_ahead = false;
  }
  street.texture = options.texture.value_or(street.texture);
  if (options.light) street.light = synthetic::parse_light(*options.light);
  street.exposure_change = options.exposure_change.value_or(street.exposure_change);
  street.noise = options.noise.value_or(street.noise);
  street.shutter = options.shutter.value_or(street.shutter);
  street.glare = options.glare.value_or(street.glare);
  return street;
}

void run_synth(SynthOptions options) {
  synthetic::SequenceSettings& settings = options.sequence;
  const bool rgbd = options.sensor == "rgbd";
  settings.sensor = rgbd ? synthetic::Sensor::rgbd : synthetic::Sensor::stereo;
  settings.size = parse_size(!options.size.empty() ? options.size : rgbd ? "640x480" : "620x188");
  settings.street = street_of(options);
  synthetic::StreetSequence sequence(settings);
  ProgressBar bar("Rendering", sequence.size());
  const auto progress = [&](int done) { bar.update(done); };
  if (rgbd) {
    synthetic::write_tum_layout(sequence, options.out, options.overwrite, progress);
  } else {
    synthetic::write_kitti_layout(sequence, options.out, options.overwrite, progress);
  }
  fmt::print("{} {} of {}x{} in {} ({:.1f} a second)\n", sequence.size(),
             rgbd ? "RGB-D frames" : "stereo pairs", settings.size.width, settings.size.height,
             options.out.string(), bar.rate());
}

void add_output_options(CLI::App* command, SynthOptions& options) {
  synthetic::SequenceSettings& sequence = options.sequence;
  command->add_option("--out", options.out, "Folder to write; new or empty")->required()->type_name("DIR");
  command->add_flag("--overwrite", options.overwrite, "Replace the sequence in a folder that is not empty");
  command->add_option("--sensor", options.sensor, "stereo: KITTI layout; rgbd: TUM layout, noisy depth")
      ->check(CLI::IsMember({"stereo", "rgbd"}))
      ->capture_default_str();
  command
      ->add_option("--frames", sequence.frames, "Frames at 10 per second; default 60, or all of a pose file")
      ->check(CLI::Range(1, 20000))
      ->type_name("N");
  command->add_option("--size", options.size, "Image size in pixels; default 620x188, or 640x480 for rgbd")
      ->type_name("WxH");
  command->add_flag("--colour", sequence.colour, "Write colour images as well (image_2, image_3)");
  command->add_flag("--depth", sequence.depth, "Write depth of the left image (16-bit PNG, 256 = 1 m)");
  command->add_flag("--disparity", sequence.disparity, "Write its disparity (16-bit PNG, 256 = 1 pixel)");
  command->add_flag("--flow", sequence.flow, "Write its optical flow to the next frame (KITTI's 16-bit PNG)");
  command->add_flag("--annotations", sequence.annotations,
                    "Write annotations/instances.json: COCO instances with amodal masks and occlusion");
  command->add_flag("--amodal", sequence.amodal, "Write the whole mask of every object as an image");
}

void add_street_options(CLI::App* command, SynthOptions& options) {
  command->add_option("--preset", options.preset, "easy, street, crowded, lorry or lorry-close")
      ->capture_default_str()
      ->type_name("NAME");
  command
      ->add_option("--path", options.sequence.path,
                   "Where to drive: block, eight, straight, or a KITTI pose file")
      ->capture_default_str()
      ->type_name("PATH");
  command->add_option("--seed", options.sequence.seed, "Another seed makes another street")
      ->capture_default_str()
      ->type_name("N");
  const char* group = "In place of the preset's values";
  const auto number = [&](const char* name, std::optional<float>& value, const char* help) {
    command->add_option(name, value, help)->type_name("X")->group(group);
  };
  number("--parked", options.parked, "Share of the parking places that are taken, 0..1");
  number("--moving", options.moving, "Share of all cars that move, 0..1");
  number("--traffic", options.traffic, "Times as many oncoming cars, cyclists and people, 0..20");
  command->add_option("--lorry", options.lorry, "A lorry ahead: its nearest and farthest gap in metres")
      ->type_name("NEAR,FAR")
      ->group(group);
  number("--texture", options.texture, "Contrast of the noise on surfaces, 0..2; 1 is natural");
  command->add_option("--light", options.light, "sun, overcast or evening")->type_name("NAME")->group(group);
  number("--exposure-change", options.exposure_change, "How far the exposure hunts, 0..1");
  number("--noise", options.noise, "Sigma of the image noise, grey levels");
  number("--motion-blur", options.shutter, "Seconds that the shutter is open, 0..0.1 (7 times as slow)");
  number("--glare", options.glare, "Stray light: veil, ghosts of the sun, sparkles; 0..1");
}

}  // namespace

void add_synth_command(CLI::App& app) {
  auto options = std::make_shared<SynthOptions>();
  CLI::App* command =
      app.add_subcommand("synth", "Make a synthetic drive with ground truth (KITTI or TUM layout)");
  add_output_options(command, *options);
  add_street_options(command, *options);
  command->footer(
      "Examples:\n"
      "  penumbra synth --out out/street\n"
      "  penumbra synth --frames 300 --preset crowded --seed 7 --colour --annotations --out out/crowded\n"
      "  penumbra synth --path kitti/poses/07.txt --size 1241x376 --out out/07\n"
      "  penumbra synth --path eight --frames 1150 --preset lorry --light overcast --out out/lorry\n"
      "  penumbra synth --sensor rgbd --moving 0.3 --out out/rgbd\n\n"
      "docs/synthetic-street.md describes the files and the street.");
  command->callback([options] { run_synth(*options); });
}

}  // namespace penumbra::apps
