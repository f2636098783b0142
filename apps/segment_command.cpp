// penumbra segment: images in, object instances out, as pictures and as COCO results.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "apps/compute_options.h"
#include "apps/overlay.h"
#include "nn/base/error.h"
#include "nn/io/coco_rle.h"
#include "nn/io/file.h"
#include "nn/io/image_file.h"
#include "nn/models/class_names.h"
#include "nn/models/make_network.h"
#include "weights_tools/load_weights.h"

namespace penumbra::apps {

namespace {

struct SegmentOptions {
  std::vector<std::string> images;
  std::string weights, out, classes;
  float show_above = 0.5F;
  nn::NetworkConfig network;
};

// COCO numbers its images; a file name of digits only is taken as that number, any other is kept as it is.
nlohmann::json image_id(const std::filesystem::path& path) {
  const std::string stem = path.stem().string();
  const bool digits = stem.find_first_not_of("0123456789") == std::string::npos;
  if (digits && !stem.empty() && stem.size() <= 18) return std::stoll(stem);
  return stem;
}

nlohmann::json coco_result(const nn::Detection& detection, const std::filesystem::path& path,
                           const cv::Size& image) {
  const nn::Box& box = detection.box;
  return {{"image_id", image_id(path)},
          {"category_id", detection.label},
          {"bbox", {box.x1, box.y1, box.width(), box.height()}},
          {"score", detection.score},
          {"segmentation",
           {{"size", {image.height, image.width}},
            {"counts", nn::encode_runs(nn::mask_runs(detection.mask, image.width, image.height))}}}};
}

void check_names(const std::vector<std::string>& images) {
  std::set<std::string> stems;
  for (const std::string& image : images) {
    if (!stems.insert(std::filesystem::path(image).stem().string()).second) {
      throw UsageError(
          fmt::format("{}: another image of this name is in the list, their pictures would overwrite "
                      "each other",
                      image));
    }
  }
}

void segment(const SegmentOptions& options) {
  check_names(options.images);
  const nn::StateDict weights = weights_tools::load_weights(options.weights);
  const std::unique_ptr<nn::InstanceSegmenter> network = nn::make_network(weights, options.network);
  const std::vector<std::string> names = nn::class_names(weights, network->classes(), options.classes);
  const std::filesystem::path out = options.out;
  std::filesystem::create_directories(out);

  nlohmann::json results = nlohmann::json::array();
  int failed = 0;
  for (const std::string& path : options.images) {
    cv::Mat image;
    try {
      image = nn::read_image(path, nn::ImageColour::bgr);
    } catch (const Error& error) {  // the other images are still done
      spdlog::error("{}", error.what());
      ++failed;
      continue;
    }
    const auto start = std::chrono::steady_clock::now();
    const std::vector<nn::Detection> detections = (*network)(image);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    const std::filesystem::path picture =
        out / (std::filesystem::path(path).stem().string() + "_overlay.png");
    nn::write_image(picture, draw_overlay(image, detections, names, options.show_above));
    fmt::print("{}: {} x {}, {} instances in {:.2f} s -> {}\n", path, image.cols, image.rows,
               detections.size(), seconds, picture.string());
    for (const nn::Detection& detection : detections) {
      results.push_back(coco_result(detection, path, image.size()));
      if (detection.score < options.show_above) continue;
      const nn::Box& box = detection.box;
      fmt::print("  {:<16} {:.3f}  ({:.1f}, {:.1f}) - ({:.1f}, {:.1f})\n",
                 names[static_cast<std::size_t>(detection.label)], detection.score, box.x1, box.y1, box.x2,
                 box.y2);
    }
  }
  nn::write_file(out / "results.json", results.dump(1) + "\n");
  fmt::print("COCO results: {}\n", (out / "results.json").string());
  if (failed > 0)
    throw Error(fmt::format("{} of {} images could not be read", failed, options.images.size()));
}

// Where both kinds of network have a setting, one option sets it for both; each has its own default.
void add_network_options(CLI::App* command, nn::NetworkConfig& network) {
  nn::MaskRcnnConfig& mask_rcnn = network.mask_rcnn;
  nn::Yolov5Config& yolov5 = network.yolov5;
  command
      ->add_option("--min-size", mask_rcnn.transform.min_size,
                   "Mask R-CNN: shorter side at the network, pixels")
      ->capture_default_str()
      ->check(CLI::Range(32, 4096));
  command
      ->add_option_function<int>(
          "--max-size", [&](int size) { mask_rcnn.transform.max_size = yolov5.letterbox.size = size; },
          fmt::format("longest side at the network, pixels [Mask R-CNN {}, YOLOv5 {}]",
                      mask_rcnn.transform.max_size, yolov5.letterbox.size))
      ->check(CLI::Range(32, 8192));
  command
      ->add_option_function<float>(
          "--score-threshold",
          [&](float score) { mask_rcnn.box_head.score_threshold = yolov5.score_threshold = score; },
          fmt::format("least score of any instance [Mask R-CNN {}, YOLOv5 {}]",
                      mask_rcnn.box_head.score_threshold, yolov5.score_threshold))
      ->check(CLI::Range(0.0, 1.0));
  command
      ->add_option_function<int>(
          "--max-detections",
          [&](int count) { mask_rcnn.box_head.max_detections = yolov5.max_detections = count; },
          fmt::format("most instances an image [Mask R-CNN {}, YOLOv5 {}]", mask_rcnn.box_head.max_detections,
                      yolov5.max_detections))
      ->check(CLI::Range(1, 1000));
  command->add_flag("!--no-attention", mask_rcnn.attention,
                    "leave the weights' attention out: the baseline network");
}

}  // namespace

void add_segment_command(CLI::App& app) {
  auto options = std::make_shared<SegmentOptions>();
  CLI::App* command =
      app.add_subcommand("segment", "Find object instances in images with Mask R-CNN or YOLOv5");
  command->add_option("images", options->images, "PNG or JPEG images")->required();
  command
      ->add_option("--weights", options->weights,
                   "Mask R-CNN (torchvision's names) or YOLOv5: safetensors or .pth")
      ->required();
  command->add_option("--out", options->out, "folder for the pictures and results.json; made if missing")
      ->required();
  command->add_option("--classes", options->classes,
                      "file of class names, one a line (default: the weights' own, or COCO)");
  command
      ->add_option("--show-above", options->show_above,
                   "least score of instances in the picture and the list")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  add_network_options(command, options->network);
  add_threads_option(command);
  add_isa_option(command);
  command->footer(
      "Examples:\n"
      "  penumbra segment street.png --weights maskrcnn.safetensors --out found\n"
      "  penumbra segment *.jpg --weights maskrcnn_resnet50_fpn.pth --out found --show-above 0.7\n"
      "Writes NAME_overlay.png for every image and results.json, COCO's result format with RLE masks.");
  command->callback([options] { segment(*options); });
}

}  // namespace penumbra::apps
