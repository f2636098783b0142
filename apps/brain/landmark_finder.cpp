#include "apps/brain/landmark_finder.h"

#include <fmt/format.h>

#include "apps/network/load_network.h"
#include "nn/base/error.h"

namespace penumbra::apps {

namespace {

constexpr const char* kInterestWeights = "weights_tools/models/penumbra-interest.safetensors";

const std::filesystem::path& existing(const std::filesystem::path& weights) {
  if (std::error_code none; std::filesystem::exists(weights, none)) return weights;
  throw InputError(weights.string(),
                   fmt::format("weights of the interest network (--weights FILE; those that ship are {})",
                               kInterestWeights),
                   "no such file");
}

}  // namespace

ImageLandmarks::ImageLandmarks(const std::filesystem::path& weights,
                               const slam::brain::RegionSettings& settings)
    : network_(load_noted_weights(existing(weights), "")), regions_(settings) {
  if (network_.classes() != slam::brain::kLandmarkClasses ||
      network_.embedding() != slam::brain::kDescriptorSize) {
    throw InputError(weights.string(),
                     fmt::format("{} classes and an embedding of {} numbers", slam::brain::kLandmarkClasses,
                                 slam::brain::kDescriptorSize),
                     fmt::format("{} and {}", network_.classes(), network_.embedding()));
  }
}

void ImageLandmarks::operator()(const ByteView& image, slam::brain::Landmarks& landmarks) {
  network_(image, arena_, map_);
  slam::brain::ImageCells cells;
  cells.width = map_.width;
  cells.height = map_.height;
  cells.left = map_.left;
  cells.top = map_.top;
  cells.size = map_.size;
  cells.image_width = image.width;
  cells.image_height = image.height;
  cells.probabilities = map_.probabilities;
  cells.embeddings = map_.embeddings;
  regions_(cells, landmarks);
}

std::function<void(const slam::StereoImages&, slam::brain::Landmarks&)> make_landmark_finder(
    const std::filesystem::path& weights, const slam::brain::RegionSettings& settings) {
  const auto finder = std::make_shared<ImageLandmarks>(weights, settings);
  return [finder](const slam::StereoImages& images, slam::brain::Landmarks& landmarks) {
    (*finder)(images.left, landmarks);
  };
}

void add_interest_weights_option(CLI::App* command, std::filesystem::path& weights) {
  weights = kInterestWeights;
  command->add_option("--weights", weights, "The interest network's weights")
      ->capture_default_str()
      ->type_name("FILE");
}

}  // namespace penumbra::apps
