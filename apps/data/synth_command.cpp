// penumbra synth: renders a drive through the synthetic street or a recording of the synthetic office.
#include <fmt/core.h>

#include <cstdio>
#include <memory>
#include <optional>

#include "apps/common/commands.h"
#include "apps/common/image_size.h"
#include "apps/common/progress_bar.h"
#include "nn/base/error.h"
#include "slam/world/layouts.h"
#include "slam/world/office_sequence.h"
#include "slam/world/street_sequence.h"

namespace penumbra::apps {

namespace {

namespace synthetic = slam::synthetic;

struct SynthOptions {
  std::string scene = "street", sensor;
  std::optional<std::string> preset, path;
  std::optional<std::string> size;
  int frames = 0;
  std::uint32_t seed = 1;
  bool colour = false, depth = false, disparity = false, flow = false, annotations = false, amodal = false,
       landmarks = false;
  std::filesystem::path out;
  bool overwrite = false;
  // What replaces the preset's values.
  std::optional<float> parked, traffic, moving, texture, exposure_change, noise, shutter, glare, readout,
      depth_delay, lamps;
  std::optional<std::string> light, lorry, people, depth_sensor;
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

void refuse(bool given, const char* option, const char* scene) {
  if (given) throw UsageError(fmt::format("{} is not for --scene {}", option, scene));
}

synthetic::StreetSettings street_of(const SynthOptions& options) {
  synthetic::StreetSettings street = synthetic::street_preset(options.preset.value_or("street"));
  street.parked_cars = options.parked.value_or(street.parked_cars);
  street.traffic = options.traffic.value_or(street.traffic);
  if (options.moving) street.moving = options.moving;
  if (options.lorry) {
    street.lorry = parse_gaps(*options.lorry);
    street.car_ahead = false;
  }
  street.lamps_per_100m = options.lamps.value_or(street.lamps_per_100m);
  street.texture = options.texture.value_or(street.texture);
  if (options.light) street.light = synthetic::parse_light(*options.light);
  street.exposure_change = options.exposure_change.value_or(street.exposure_change);
  street.noise = options.noise.value_or(street.noise);
  street.shutter = options.shutter.value_or(street.shutter);
  street.glare = options.glare.value_or(street.glare);
  return street;
}

std::unique_ptr<synthetic::Sequence> make_street(const SynthOptions& options) {
  refuse(options.people || options.depth_sensor || options.readout || options.depth_delay,
         "--people, --depth-sensor, --rolling-shutter or --depth-delay", "street");
  const bool rgbd = options.sensor == "rgbd";
  synthetic::SequenceSettings settings;
  settings.street = street_of(options);
  settings.sensor = rgbd ? synthetic::Sensor::rgbd : synthetic::Sensor::stereo;
  settings.path = options.path.value_or(settings.street.alike ? "straight" : settings.path);
  settings.frames = options.frames;
  settings.size = parse_size(options.size.value_or(rgbd ? "640x480" : "620x188"));
  settings.seed = options.seed;
  settings.annotations = options.annotations;
  settings.colour = options.colour;
  settings.depth = options.depth;
  settings.disparity = options.disparity;
  settings.flow = options.flow;
  settings.amodal = options.amodal;
  settings.landmarks = options.landmarks;
  return std::make_unique<synthetic::StreetSequence>(settings);
}

std::unique_ptr<synthetic::Sequence> make_office(const SynthOptions& options) {
  refuse(options.sensor == "stereo", "--sensor stereo", "office");
  refuse(options.parked || options.traffic || options.moving || options.lorry || options.lamps,
         "--parked, --traffic, --moving, --lorry or --lamps", "office");
  refuse(options.light || options.glare, "--light or --glare", "office");
  refuse(options.disparity, "--disparity", "office");
  synthetic::OfficeSettings settings = synthetic::office_preset(options.preset.value_or("walking-xyz"));
  if (options.people) settings.people = synthetic::parse_people(*options.people);
  if (options.depth_sensor == "simple") {
    settings.depth_camera.reset();
  } else if (options.depth_sensor) {
    settings.depth_camera = synthetic::depth_camera(*options.depth_sensor);
  }
  settings.path = options.path.value_or(settings.path);
  settings.frames = options.frames;
  settings.size = parse_size(options.size.value_or("640x480"));
  settings.seed = options.seed;
  settings.texture = options.texture.value_or(settings.texture);
  settings.exposure_change = options.exposure_change.value_or(settings.exposure_change);
  settings.noise = options.noise.value_or(settings.noise);
  settings.shutter = options.shutter.value_or(settings.shutter);
  settings.readout = options.readout.value_or(settings.readout);
  settings.depth_delay = options.depth_delay.value_or(0.0F) / 1000.0F;
  settings.annotations = options.annotations;
  settings.flow = options.flow;
  settings.amodal = options.amodal;
  settings.landmarks = options.landmarks;
  return std::make_unique<synthetic::OfficeSequence>(settings);
}

void run_synth(const SynthOptions& options) {
  const std::unique_ptr<synthetic::Sequence> sequence =
      options.scene == "office" ? make_office(options) : make_street(options);
  const bool rgbd = sequence->recording().sensor == synthetic::Sensor::rgbd;
  ProgressBar bar("Rendering", sequence->size());
  const auto progress = [&](int done) { bar.update(done); };
  if (rgbd) {
    synthetic::write_tum_layout(*sequence, options.out, options.overwrite, progress);
  } else {
    synthetic::write_kitti_layout(*sequence, options.out, options.overwrite, progress);
  }
  fmt::print("{} {} of {}x{} in {} ({:.1f} a second)\n", sequence->size(),
             rgbd ? "RGB-D frames" : "stereo pairs", sequence->image_size().width,
             sequence->image_size().height, options.out.string(), bar.rate());
}

void add_output_options(CLI::App* command, SynthOptions& options) {
  command->add_option("--out", options.out, "Folder to write; new or empty")->required()->type_name("DIR");
  command->add_flag("--overwrite", options.overwrite, "Replace the sequence in a folder that is not empty");
  command
      ->add_option("--sensor", options.sensor,
                   "stereo: KITTI layout; rgbd: TUM layout, noisy depth (default: stereo; office: rgbd)")
      ->check(CLI::IsMember({"stereo", "rgbd"}));
  command
      ->add_option("--frames", options.frames,
                   "Frames; street: 10 per second, default 60; office: 30 per second, default 300, twolaps "
                   "1500; or all of a pose file")
      ->check(CLI::Range(1, 20000))
      ->type_name("N");
  command->add_option("--size", options.size, "Image size in pixels; default 620x188, or 640x480 for rgbd")
      ->type_name("WxH");
  command->add_flag("--colour", options.colour, "Write colour images as well (image_2, image_3)");
  command->add_flag("--depth", options.depth, "Write depth of the left image (16-bit PNG, 256 = 1 m)");
  command->add_flag("--disparity", options.disparity, "Write its disparity (16-bit PNG, 256 = 1 pixel)");
  command->add_flag("--flow", options.flow, "Write its optical flow to the next frame (KITTI's 16-bit PNG)");
  command->add_flag("--annotations", options.annotations,
                    "Write annotations/instances.json: COCO instances with amodal masks and occlusion");
  command->add_flag(
      "--landmarks", options.landmarks,
      "Write the number of the thing that each pixel of the left image shows, houses and trees too");
  command->add_flag("--amodal", options.amodal, "Write the whole mask of every object as an image");
}

void add_scene_options(CLI::App* command, SynthOptions& options) {
  command->add_option("--scene", options.scene, "street, or office: a room with people, by RGB-D")
      ->check(CLI::IsMember({"street", "office"}))
      ->capture_default_str()
      ->type_name("NAME");
  command
      ->add_option(
          "--preset", options.preset,
          "street: easy, street, crowded, lorry, lorry-close or alike (equal houses and lamps, no loop); "
          "office: walking- or sitting- with xyz, "
          "static, rpy or halfsphere; desk, twolaps (default: street; office: walking-xyz)")
      ->type_name("NAME");
  command
      ->add_option(
          "--path", options.path,
          "street: block, eight, straight, corner, or a KITTI pose file; office: still, xyz, rpy, "
          "halfsphere, "
          "desk, twolaps, or a TUM pose file (default: block, alike: straight; office: the preset's)")
      ->type_name("PATH");
  command->add_option("--seed", options.seed, "Another seed makes another street or office")
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
  number("--lamps", options.lamps, "Equal lamp posts per 100 m along both pavements, 0..50");
  number("--texture", options.texture, "Contrast of the noise on surfaces, 0..2; 1 is natural");
  command->add_option("--light", options.light, "sun, overcast or evening")->type_name("NAME")->group(group);
  command->add_option("--people", options.people, "In the office: walking, sitting or none")
      ->type_name("NAME")
      ->group(group);
  command
      ->add_option(
          "--depth-sensor", options.depth_sensor,
          "In the office: kinect (v1, as TUM's; the preset's), d435 or simple (noise and shadow only)")
      ->type_name("NAME")
      ->group(group);
  number("--exposure-change", options.exposure_change, "How far the exposure hunts, 0..1");
  number("--noise", options.noise, "Sigma of the image noise, grey levels");
  number("--motion-blur", options.shutter,
         "Seconds that the shutter is open, 0..0.1, office 0..0.033 (7 times as slow)");
  number("--rolling-shutter", options.readout,
         "In the office: seconds from the first row's exposure to the last one's, 0..0.033");
  command
      ->add_option(
          "--depth-delay", options.depth_delay,
          "In the office: milliseconds from each image to its depth, -30..30, as in TUM's recordings")
      ->type_name("MS")
      ->group(group);
  number("--glare", options.glare, "Stray light: veil, ghosts of the sun, sparkles; 0..1");
}

}  // namespace

void add_synth_command(CLI::App& app) {
  auto options = std::make_shared<SynthOptions>();
  CLI::App* command = app.add_subcommand(
      "synth", "Make a synthetic drive or office recording with ground truth (KITTI or TUM layout)");
  add_output_options(command, *options);
  add_scene_options(command, *options);
  command->footer(
      "Examples:\n"
      "  penumbra synth --out out/street\n"
      "  penumbra synth --frames 300 --preset crowded --seed 7 --colour --annotations --out out/crowded\n"
      "  penumbra synth --path kitti/poses/07.txt --size 1241x376 --out out/07\n"
      "  penumbra synth --path eight --frames 1150 --preset lorry --light overcast --out out/lorry\n"
      "  penumbra synth --sensor rgbd --moving 0.3 --out out/rgbd\n"
      "  penumbra synth --scene office --preset walking-xyz --seed 3 --out out/walking_xyz\n"
      "  penumbra synth --scene office --preset sitting-rpy --annotations --flow --out out/sitting_rpy\n\n"
      "docs/synthetic-street.md and docs/synthetic-office.md describe the files and the worlds.");
  command->callback([options] { run_synth(*options); });
}

}  // namespace penumbra::apps
