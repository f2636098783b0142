// penumbra eval-masks: how good masks from boxes and depth are, where the exact ones are known.
#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <span>

#include "apps/common/commands.h"
#include "apps/common/finite_number.h"
#include "apps/common/made_truth.h"
#include "apps/common/progress_bar.h"
#include "apps/slam/mask_pictures.h"
#include "apps/slam/segmenter.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/image/grey.h"
#include "nn/image/image_file.h"
#include "nn/image/shapes.h"
#include "slam/dynamics/rgbd/dbscan_masks.h"
#include "slam/dynamics/rgbd/depth_masks.h"
#include "slam/evaluation/depth_mask_evaluation.h"
#include "slam/pipeline/feature_measurer.h"
#include "slam/pipeline/setting_fields.h"
#include "slam/sources/open_dataset.h"

namespace penumbra::apps {

namespace {

constexpr int kFewestPixels = 300, kShortestSide = 24;  // of an object that is looked at

struct EvalMasksOptions {
  std::string folder, masks, people, clean, pictures;
  int step = 1, margin = 0;
  double box_error = 0.02;
};

struct Method {
  const char* name;
  slam::RepairMode repair;
  slam::ClusterMode clusters;
  int k;
};

constexpr Method kMethods[] = {
    {"paper, k = 2", slam::RepairMode::paper, slam::ClusterMode::paper, 2},
    {"paper, k = 3", slam::RepairMode::paper, slam::ClusterMode::paper, 3},
    {"grown, no repair", slam::RepairMode::off, slam::ClusterMode::grown, 8},
    {"grown, repaired", slam::RepairMode::modes, slam::ClusterMode::grown, 8},
};

// The modes of the repair that repair, with their names.
constexpr std::span kRepairs = std::span(slam::kWords<slam::RepairMode>).subspan<1>();
static_assert(slam::kWords<slam::RepairMode>[0].second == slam::RepairMode::off);

constexpr const char* kGroups[] = {"people, whole", "people, cut off", "people, behind things",
                                   "other things"};

std::size_t group_of(const slam::Instance& truth, const FloatImage& depth) {
  return truth.class_name == "person" ? static_cast<std::size_t>(slam::view_of(truth, depth)) : 3;
}

struct Mean {
  double sum = 0.0;
  int count = 0;
};

struct Results {
  std::map<std::string, std::array<Mean, 4>> iou;  // by method and group
  std::map<slam::RepairMode, slam::RepairCount> repairs;
  std::map<slam::ForegroundMode, slam::ForegroundCount> foregrounds;
};

// Writes the steps of the last method for a person who is large enough to be looked at.
void draw(const slam::StereoImages& images, const slam::Instance& truth, const Rect& box, double focal_length,
          const std::filesystem::path& folder) {
  constexpr int kLeastHeight = 120;  // pixels
  if (truth.class_name != "person" || box.height < kLeastHeight) return;
  FloatImage depth = images.depth.clone();
  slam::DepthRepair().apply(to_grey(images.left), box, depth);
  slam::ObjectMask mask;
  slam::ObjectInBox(focal_length, {}).find(images.left, depth, box, {}, mask);
  nn::write_image(folder / fmt::format("{:06d}_{}.png", images.index, box.x),
                  mask_steps(images.left, images.depth, depth, box, mask));
}

// What the methods make of an object of the frame, whose exact mask is `truth`.
void judge(const slam::StereoImages& images, const FloatImage* clean, const slam::Instance& truth,
           const Rect& box, double focal_length, Results& results) {
  const ByteImage grey = to_grey(images.left);
  const std::size_t group = group_of(truth, clean != nullptr ? *clean : images.depth);
  const auto repaired = [&](slam::RepairMode mode, const Rect& where) {
    FloatImage depth = images.depth.clone();
    slam::DepthRepairSettings settings;
    settings.mode = mode;
    slam::DepthRepair(settings).apply(grey, where, depth);
    return depth;
  };
  for (const Method& method : kMethods) {
    slam::ObjectInBoxSettings settings;
    settings.mode = method.clusters;
    settings.clusters = method.k;
    slam::ObjectMask mask;
    slam::ObjectInBox(focal_length, settings).find(images.left, repaired(method.repair, box), box, {}, mask);
    slam::Instance found;
    found.region = box;
    found.mask = mask.mask;
    Mean& mean = results.iou[method.name][group];
    mean.sum += slam::mask_iou(truth, found);
    ++mean.count;
  }
  if (clean == nullptr || group == 3) return;
  for (const auto& [name, mode] : kRepairs)
    slam::count_repair(truth, images.depth, repaired(mode, truth.region), *clean, results.repairs[mode]);
}

// What DBSCAN on the features' depths makes of the people's boxes, all of a frame at once: each ring leaves
// out the others.
void judge_foregrounds(const slam::StereoImages& images, const std::vector<slam::Instance>& people,
                       const std::vector<slam::Instance>& boxes,
                       const std::shared_ptr<const slam::FrameFeatures>& features, Results& results) {
  for (const auto& [name, mode] : slam::kWords<slam::ForegroundMode>) {
    slam::ForegroundSettings settings;
    settings.mode = mode;
    const std::vector<slam::Instance> found =
        slam::masks_by_dbscan([&](const slam::ImageToSegment&) { return boxes; }, 0.0,
                              settings)({images.index, images.left, images.depth, features});
    for (std::size_t i = 0; i < people.size(); ++i)
      slam::count_foreground(people[i], found[i], *features, results.foregrounds[mode]);
  }
}

void print(const Results& results) {
  fmt::print("Mean IoU of masks (objects)\n\n| method |");
  for (const char* group : kGroups) fmt::print(" {} |", group);
  fmt::print("\n|---|---|---|---|---|\n");
  for (const Method& method : kMethods) {
    fmt::print("| {} |", method.name);
    for (const Mean& mean : results.iou.at(method.name)) {
      if (mean.count == 0) {
        fmt::print(" |");
      } else {
        fmt::print(" {:.3f} ({}) |", mean.sum / mean.count, mean.count);
      }
    }
    fmt::print("\n");
  }
  if (!results.foregrounds.empty()) {
    fmt::print(
        "\nFeatures in people's boxes\n\n| DBSCAN | of the body, taken for the world's % | of the rest, lost "
        "% "
        "|\n|---|---|---|\n");
    for (const auto& [name, mode] : slam::kWords<slam::ForegroundMode>) {
      const slam::ForegroundCount& count = results.foregrounds.at(mode);
      fmt::print("| {} | {:.1f} ({}) | {:.1f} ({}) |\n", name, 100.0 * count.left_share(), count.body,
                 100.0 * count.lost_share(), count.background);
    }
  }
  if (results.repairs.empty()) return;
  fmt::print(
      "\nRepair in people's boxes\n\n| mode | holes on people filled % | RMSE of those m | holes of the "
      "background filled wrongly % |\n|---|---|---|---|\n");
  for (const auto& [name, mode] : kRepairs) {
    const slam::RepairCount& count = results.repairs.at(mode);
    fmt::print("| {} | {:.1f} | {:.3f} | {:.1f} |\n", name, 100.0 * count.filled_share(), count.rmse(),
               100.0 * count.wrong_share());
  }
}

void make_picture_folder(const std::filesystem::path& folder) {
  try {
    nn::make_writable_folder(folder);
  } catch (const Error& error) {
    throw Error(fmt::format("--pictures: expected a folder that can be made and written; {}", error.what()));
  }
}

void run_eval_masks(const EvalMasksOptions& options) {
  slam::DatasetOptions from;
  from.step = options.step;
  const auto dataset = slam::open_dataset(options.folder, from);
  if (dataset->sensor() != slam::Sensor::rgbd)
    throw InputError(options.folder, "an RGB-D recording", dataset->name());
  const auto place = [&](const std::string& given, const char* usual) {
    return given.empty() ? std::filesystem::path(options.folder) / usual : std::filesystem::path(given);
  };
  const slam::Segmenter truths = options.people.empty()
                                     ? make_mask_reader(place(options.masks, "instances"))
                                     : make_people_mask_reader(options.people, options.margin);
  std::optional<TrueDepths> clean_depths;
  const std::filesystem::path clean_folder = place(options.clean, "depth_clean");
  if (!options.clean.empty() || std::filesystem::exists(clean_folder))
    clean_depths.emplace(options.folder, clean_folder);

  if (!options.pictures.empty()) make_picture_folder(options.pictures);
  Results results;
  for (const Method& method : kMethods) results.iou[method.name] = {};
  slam::FeatureMeasurer measurer(dataset->sensor(), slam::OrbSettings{}, 1);
  StageTimer timer;
  ProgressBar progress("Masks", dataset->size());
  for (int i = 0; i < dataset->size(); ++i) {
    const slam::StereoImages images = dataset->load(i);
    FloatImage clean;
    if (clean_depths && clean_depths->has(images.index))
      clean = clean_depths->load(images.index, images.left.size());
    std::uint64_t number = 0;
    std::vector<slam::Instance> people, boxes;
    for (const slam::Instance& truth : truths({images.index, images.left, images.depth})) {
      ++number;
      if (count_pixels(truth.mask) < kFewestPixels || truth.region.width < kShortestSide ||
          truth.region.height < kShortestSide)
        continue;
      const Rect box =
          slam::jittered(truth.region, options.box_error,
                         static_cast<std::uint64_t>(images.index) * 1000 + number, images.left.size());
      if (!options.pictures.empty()) draw(images, truth, box, dataset->camera().fx, options.pictures);
      judge(images, clean.empty() ? nullptr : &clean, truth, box, dataset->camera().fx, results);
      if (truth.class_name != "person") continue;
      people.push_back(truth);
      boxes.emplace_back().region = box;
    }
    if (!people.empty()) {
      judge_foregrounds(images, people, boxes, measurer.measure(images, dataset->camera(), 1.0, timer),
                        results);
    }
    progress.update(i + 1);
  }
  print(results);
}

}  // namespace

void add_eval_masks_command(CLI::App& app) {
  const auto options = std::make_shared<EvalMasksOptions>();
  CLI::App* command = app.add_subcommand("eval-masks", "Compare masks from boxes and depth with exact ones");
  command->footer(R"(Examples:
  penumbra eval-masks out/walking_xyz --step 5
  penumbra eval-masks out/walking_xyz --box-error 0 --pictures out/steps
  penumbra eval-masks out/fr3_frame --people-masks out/fr3_frame/people --mask-margin 8

Takes the boxes of exact masks, off by --box-error as a detector's are, and finds the objects in them by depth: in the letter of
the paper and as --dynamics depth-clusters does, and which features in them as --dynamics static-points does. Prints the mean IoU
with the exact masks, people by how they are seen, and, where the recording has clean depth, what each way to repair it fills, and how well. docs/dynamics/depth-clusters.md has the table.)");
  command->add_option("folder", options->folder, "RGB-D recording, as `penumbra synth` writes it")
      ->required();
  command->add_option("--masks", options->masks, "its exact masks (default: instances in the folder)")
      ->type_name("DIR");
  CLI::Option* people =
      command
          ->add_option("--people-masks", options->people,
                       "instead of exact masks 8-bit ones that are 0 on people, as DynaSLAM saves "
                       "them")
          ->excludes("--masks")
          ->type_name("DIR");
  command->add_option("--mask-margin", options->margin, "pixels by which those are too wide")
      ->needs(people)
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  command
      ->add_option("--clean-depth", options->clean,
                   "its depth without noise (default: depth_clean in the folder)")
      ->type_name("DIR");
  command
      ->add_option(
          "--pictures", options->pictures,
          "folder for pictures of the steps, one for each person and frame; made where it is missing")
      ->type_name("DIR");
  command->add_option("--step", options->step, "every how many frames")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--box-error", options->box_error, "most that a box's side is off, share of the box")
      ->check(number_from(0.0, 0.5, "a share from 0 to 0.5"))
      ->capture_default_str();
  command->callback([options] { run_eval_masks(*options); });
}

}  // namespace penumbra::apps
