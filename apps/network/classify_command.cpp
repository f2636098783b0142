// penumbra classify: images in, class names and probabilities out.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/compute_options.h"
#include "apps/common/log.h"
#include "apps/network/image_list.h"
#include "apps/network/load_network.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/layers/activations.h"
#include "nn/models/class_names.h"
#include "nn/models/classifier.h"

namespace penumbra::apps {

namespace {

struct ClassifyOptions {
  std::vector<std::string> images;
  std::string weights, key, classes;
  int top = 5;
  nn::ImageOrientation orientation = nn::ImageOrientation::upright;
  bool json = false;
};

struct Guess {
  int label;
  float logit, probability;
};

std::vector<Guess> best_guesses(std::vector<float> logits, int count) {
  std::vector<Guess> guesses;
  for (const int label : nn::best_classes(logits, count)) {
    guesses.push_back({label, logits[static_cast<std::size_t>(label)], 0.0F});
  }
  nn::softmax(logits);
  for (Guess& guess : guesses) guess.probability = logits[static_cast<std::size_t>(guess.label)];
  return guesses;
}

void classify(const ClassifyOptions& options) {
  const nn::StateDict weights = load_noted_weights(options.weights, options.key);
  const nn::Classifier network(weights);
  const std::vector<std::string> names = nn::output_names(weights, network.classes(), options.classes);
  nn::Arena arena;
  nlohmann::json results = nlohmann::json::array();
  std::size_t failed = 0;
  const std::vector<ListedImage> images = list_files(options.images);
  for (const ListedImage& listed : images) {
    const std::string path = listed.path.string();
    ByteImage image;
    try {
      image = read_listed_image(listed, options.orientation);
    } catch (const Error& error) {  // the other images are still done
      log_error("{}", error.what());
      ++failed;
      continue;
    }
    const std::vector<Guess> guesses = best_guesses(network(image, arena), options.top);
    nlohmann::json entries = nlohmann::json::array();
    if (!options.json) fmt::print("{}:\n", path);
    for (const Guess& guess : guesses) {
      const std::string& name = names[static_cast<std::size_t>(guess.label)];
      if (options.json) {
        entries.push_back({{"class", guess.label},
                           {"name", name},
                           {"probability", guess.probability},
                           {"logit", guess.logit}});
      } else {
        fmt::print("  {:>4}  {:<24} {:.4f}\n", guess.label, name, guess.probability);
      }
    }
    results.push_back({{"image", path}, {"top", std::move(entries)}});
  }
  if (options.json) fmt::print("{}\n", results.dump(1));
  if (failed > 0) {
    throw Error(fmt::format("{} of {} could not be read", failed, counted(images.size(), "image")));
  }
}

}  // namespace

void add_classify_command(CLI::App& app) {
  auto options = std::make_shared<ClassifyOptions>();
  CLI::App* command = app.add_subcommand("classify", "Name what images show with a ResNet");
  command->add_option("images", options->images, "PNG, JPEG, PGM or BMP images, or folders of them")
      ->required();
  command
      ->add_option("--weights", options->weights,
                   "ResNet-18, 34, 50, 101 or 152 (torchvision's names): safetensors, .pt or .pth")
      ->required();
  add_key_option(command, options->key);
  command->add_option("--top", options->top, "classes listed an image")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  command->add_option("--classes", options->classes,
                      "file of class names, one a line (default: the weights' own, or numbers)");
  command->add_flag("--json", options->json, "print JSON: class, name, probability and logit");
  add_orientation_option(command, options->orientation);
  add_threads_option(command);
  add_isa_option(command);
  command->footer(
      "Examples:\n"
      "  penumbra classify bird.jpg --weights resnet50.pth --classes imagenet_classes.txt\n"
      "  penumbra classify *.jpg --weights resnet18.safetensors --top 1 --json\n"
      "Images are resized to 256 pixels and cropped to 224 x 224 as torchvision's ImageNet presets do.");
  command->callback([options] { classify(*options); });
}

}  // namespace penumbra::apps
