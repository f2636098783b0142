// penumbra segment: images in, object instances out, as pictures and as COCO results.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/compute_options.h"
#include "apps/common/finite_number.h"
#include "apps/common/interruption.h"
#include "apps/common/log.h"
#include "apps/common/progress_bar.h"
#include "apps/network/image_list.h"
#include "apps/network/load_network.h"
#include "apps/network/network_options.h"
#include "apps/network/overlay.h"
#include "apps/network/segment_report.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/parallel.h"
#include "nn/evaluation/coco_results.h"
#include "nn/image/image_file.h"
#include "nn/simd/isa.h"

namespace penumbra::apps {

namespace {

constexpr const char* kSegmentExamples = R"(Examples:
  penumbra segment street.png --weights maskrcnn.safetensors --out found
  penumbra segment *.jpg --weights maskrcnn_resnet50_fpn.pth --out found --show-above 0.7
  penumbra segment street.png --weights maskrcnn.safetensors --out found --json
  penumbra segment --coco-images val2017 --annotations instances_val2017.json --weights w.safetensors --out found
Writes results.json, COCO's result format with RLE masks, and NAME_overlay.png for every image (for a COCO set
with --pictures). `penumbra eval-coco` evaluates the results of a set.)";

struct SegmentOptions {
  std::vector<std::string> images;
  std::string coco_images, annotations;
  std::string weights, key, out, classes;
  float show_above = 0.5F;
  bool pictures = false, json = false;
  nn::NetworkConfig network;
  nn::ImageOrientation orientation = nn::ImageOrientation::upright;

  bool whole_set() const { return !coco_images.empty(); }
};

// The images of a run, and the data set that they belong to, if any.
struct SegmentInput {
  std::vector<ListedImage> images;
  std::optional<nn::CocoAnnotations> data_set;
};

SegmentInput find_images(const SegmentOptions& options) {
  if (options.images.empty() == options.coco_images.empty()) {
    throw UsageError("give either images or --coco-images with --annotations");
  }
  SegmentInput input;
  if (options.whole_set()) {
    input.data_set = nn::read_coco_images(options.annotations);
    input.images = list_coco_images(options.coco_images, *input.data_set);
  } else {
    input.images = list_files(options.images);
  }
  return input;
}

// The category id of each class in the results: its number, or in a data set the category of its name.
std::vector<std::optional<std::int64_t>> find_categories(const SegmentInput& input,
                                                         const std::vector<std::string>& names) {
  if (input.data_set) return category_ids(names, *input.data_set);
  std::vector<std::optional<std::int64_t>> labels;
  for (std::size_t label = 0; label < names.size(); ++label) labels.emplace_back(label);
  return labels;
}

// One run over all images; a failed image is reported and the others are still done.
class SegmentRun {
 public:
  SegmentRun(const SegmentOptions& options, const SegmentInput& input)
      : options_(options),
        input_(input),
        loaded_(load_network(options.weights, options.classes, options.network, options.key)),
        categories_(find_categories(input, loaded_.names)) {}

  void run() {
    {
      std::optional<ProgressBar> progress;
      if (options_.whole_set())
        progress.emplace("Segmenting", static_cast<int>(input_.images.size()), "images");
      int done = 0;
      for (const ListedImage& image : input_.images) {
        if (Interruption::requested()) break;
        segment(image);
        if (progress) progress->update(++done);
      }
    }
    if (segmented_ == 0 && !is_complete()) throw_incomplete();
    const std::filesystem::path file = results_file();
    results_.write(file);
    if (left_out_ > 0) {
      log_warning("left out: {} of classes that {} does not have", counted(left_out_, "instance"),
                  options_.annotations);
    }
    if (options_.json) {
      print_json(file);
    } else {
      if (options_.whole_set()) print_summary();
      fmt::print("COCO results: {}\n", file.string());
    }
    if (!is_complete()) throw_incomplete();
  }

 private:
  bool is_complete() const { return static_cast<std::size_t>(segmented_) == input_.images.size(); }

  [[noreturn]] void throw_incomplete() const {
    if (Interruption::requested()) {
      throw Error(fmt::format("interrupted by {} after {} of {}", Interruption::signal_name(),
                              segmented_ + static_cast<int>(failed_.size()),
                              counted(input_.images.size(), "image")));
    }
    throw Error(
        fmt::format("{} of {} could not be read", failed_.size(), counted(input_.images.size(), "image")));
  }

  // Results without those of some images do not take the place of earlier ones, which may be complete.
  std::filesystem::path results_file() const {
    const std::filesystem::path folder = options_.out;
    if (is_complete() || !std::filesystem::exists(folder / "results.json")) return folder / "results.json";
    log_warning(
        "{}: left as it is, as not all images were segmented now; the others' results are in "
        "results_partial.json",
        (folder / "results.json").string());
    return folder / "results_partial.json";
  }

  void segment(const ListedImage& listed) {
    ByteImage image;
    try {
      image = read_listed_image(listed, options_.orientation);
    } catch (const Error& error) {
      log_error("{}", error.what());
      failed_.push_back(listed.path.string());
      return;
    }
    const auto start = std::chrono::steady_clock::now();
    const std::vector<nn::Detection> detections = (*loaded_.network)(image);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    seconds_ += seconds;
    ++segmented_;
    for (const nn::Detection& detection : detections) add_result(listed, detection, image.size());
    report(listed, image, detections, seconds);
  }

  void add_result(const ListedImage& listed, const nn::Detection& detection, const Size& size) {
    const auto& category = categories_[static_cast<std::size_t>(detection.label)];
    if (category) {
      results_.add(listed.id, *category, detection, size.width, size.height);
    } else {
      ++left_out_;
    }
  }

  void report(const ListedImage& listed, const ByteImage& image, const std::vector<nn::Detection>& detections,
              double seconds) {
    SegmentedImage segmented{listed.path, image.size(), detections, seconds, std::nullopt};
    if (options_.pictures || !options_.whole_set()) {
      segmented.picture = std::filesystem::path(options_.out) / picture_name(listed);
      try {  // a picture that cannot be written costs only itself
        nn::write_image(*segmented.picture,
                        draw_overlay(image, detections, loaded_.names, options_.show_above));
      } catch (const Error& error) {
        log_warning("left out: {}", error.what());
        segmented.picture.reset();
      }
    }
    if (options_.json) {
      report_.push_back(image_json(segmented, loaded_.names,
                                   options_.whole_set() ? std::nullopt : std::optional(options_.show_above)));
    } else if (!options_.whole_set()) {
      fmt::print("{}", image_text(segmented, loaded_.names, options_.show_above));
    }
  }

  void print_summary() const {
    fmt::print("{}, {}, {:.3f} s an image, {:.0f} MB of activations\n", counted(segmented_, "image"),
               counted(results_.size() + left_out_, "instance"), segmented_ > 0 ? seconds_ / segmented_ : 0.0,
               static_cast<double>(loaded_.network->arena().peak_bytes()) * 1e-6);
  }

  void print_json(const std::filesystem::path& results) const {
    const nlohmann::ordered_json json = {{"network", loaded_.network->name()},
                                         {"isa", nn::to_string(nn::current_isa())},
                                         {"threads", thread_count()},
                                         {"peak_arena_bytes", loaded_.network->arena().peak_bytes()},
                                         {"seconds", seconds_},
                                         {"instances", results_.size() + left_out_},
                                         {"results", results.string()},
                                         {"failed", failed_},
                                         {"images", report_}};
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  }

  const SegmentOptions& options_;
  const SegmentInput& input_;
  LoadedNetwork loaded_;
  std::vector<std::optional<std::int64_t>> categories_;
  nn::CocoResultsWriter results_;
  nlohmann::ordered_json report_ = nlohmann::ordered_json::array();  // an entry an image
  std::vector<std::string> failed_;
  std::size_t left_out_ = 0;
  int segmented_ = 0;
  double seconds_ = 0.0;
};

void segment(const SegmentOptions& options) {
  const SegmentInput input = find_images(options);
  if (options.pictures || !options.whole_set()) check_picture_names(input.images);
  SegmentRun run(options, input);
  nn::make_writable_folder(options.out);
  const Interruption interruption;  // until the results are written
  run.run();
}

}  // namespace

void add_segment_command(CLI::App& app) {
  auto options = std::make_shared<SegmentOptions>();
  CLI::App* command =
      app.add_subcommand("segment", "Find object instances in images with Mask R-CNN, YOLOv5 or AFNET");
  command->add_option("images", options->images, "PNG, JPEG, PGM or BMP images, or folders of them");
  CLI::Option* coco_images =
      command->add_option("--coco-images", options->coco_images, "folder with the images of a COCO data set");
  CLI::Option* annotations = command->add_option(
      "--annotations", options->annotations,
      "the data set's instances JSON: file names, sizes and ids; classes go by its names");
  coco_images->needs(annotations);
  annotations->needs(coco_images);
  command->add_flag("--pictures", options->pictures, "draw the pictures of a COCO data set too")
      ->needs(coco_images);
  command->add_flag("--json", options->json,
                    "print JSON instead of text: images, seconds, peak_arena_bytes, threads, isa");
  command
      ->add_option("--weights", options->weights,
                   "Mask R-CNN (torchvision's names), YOLOv5 or AFNET: safetensors, .pt or .pth")
      ->required();
  add_key_option(command, options->key);
  command->add_option("--out", options->out, "folder for the pictures and results.json; made if missing")
      ->required();
  command->add_option("--classes", options->classes,
                      "file of class names, one a line (default: the weights' own, or COCO)");
  command
      ->add_option("--show-above", options->show_above,
                   "least score of instances in the picture and the list")
      ->capture_default_str()
      ->check(number_from(0.0, 1.0, "a score from 0 to 1"));
  add_orientation_option(command, options->orientation);
  add_network_options(command, options->network);
  add_threads_option(command);
  add_isa_option(command);
  command->footer(kSegmentExamples);
  command->callback([options] { segment(*options); });
}

}  // namespace penumbra::apps
