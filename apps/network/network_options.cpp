#include "apps/network/network_options.h"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "apps/common/finite_number.h"

namespace penumbra::apps {

void add_mask_rcnn_options(CLI::App* command, nn::MaskRcnnConfig& mask_rcnn) {
  command
      ->add_option_function<int>(
          "--min-size", [&](int size) { mask_rcnn.min_size = size; },
          fmt::format("Mask R-CNN: shorter side at the network, pixels [the weights' own, or {}]",
                      mask_rcnn.transform.min_size))
      ->check(CLI::Range(32, 4096));
  command
      ->add_option_function<int>(
          "--proposals", [&](int count) { mask_rcnn.proposals = count; },
          fmt::format(
              "Mask R-CNN: most regions that reach the heads; fewer are faster [the weights' own, or {}]",
              mask_rcnn.rpn.proposals))
      ->check(CLI::Range(1, 10000));
}

void add_precision_option(CLI::App* command, std::function<void(const nn::LayerPrecision&)> set) {
  constexpr const char* kAutomatic = "auto";
  command
      ->add_option_function<std::string>(
          "--precision",
          [set = std::move(set)](const std::string& name) {
            nn::LayerPrecision precision;
            precision.automatic = name == kAutomatic;
            if (!precision.automatic) precision.precision = nn::precision_from_name(name);
            set(precision);
          },
          "numbers that are multiplied: f32, bf16, int8 (for weights that `calibrate` has seen), or auto: "
          "the "
          "fastest of them here [f32]")
      ->check(CLI::IsMember({"f32", "bf16", "int8", kAutomatic}));
}

void add_network_options(CLI::App* command, nn::NetworkConfig& network) {
  nn::MaskRcnnConfig& mask_rcnn = network.mask_rcnn;
  nn::Yolov5Config& yolov5 = network.yolov5;
  add_mask_rcnn_options(command, mask_rcnn);
  command
      ->add_option_function<int>(
          "--max-size",
          [&](int size) {
            mask_rcnn.max_size = size;
            yolov5.max_size = size;
          },
          fmt::format("longest side at the network, pixels [the weights' own, or Mask R-CNN {}, YOLOv5 {}]",
                      mask_rcnn.transform.max_size, yolov5.letterbox.size))
      ->check(CLI::Range(32, 8192));
  command
      ->add_option_function<float>(
          "--score-threshold",
          [&](float score) { mask_rcnn.box_head.score_threshold = yolov5.score_threshold = score; },
          fmt::format("least score of any instance [Mask R-CNN {}, YOLOv5 {}]",
                      mask_rcnn.box_head.score_threshold, yolov5.score_threshold))
      ->check(number_from(0.0, 1.0, "a score from 0 to 1"));
  command
      ->add_option_function<int>(
          "--max-detections",
          [&](int count) { mask_rcnn.box_head.max_detections = yolov5.max_detections = count; },
          fmt::format("most instances an image [Mask R-CNN {}, YOLOv5 {}]", mask_rcnn.box_head.max_detections,
                      yolov5.max_detections))
      ->check(CLI::Range(1, 1000));
  add_precision_option(command, [&](const nn::LayerPrecision& precision) {
    mask_rcnn.precision = yolov5.precision = precision;
  });
  command->add_flag("!--no-attention", mask_rcnn.attention,
                    "leave the weights' attention out: the baseline network");
}

}  // namespace penumbra::apps
