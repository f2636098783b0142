// Finds the landmarks of images with a trained interest network: image -> network -> salient regions.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>

#include "nn/image/image.h"
#include "nn/models/interest_network.h"
#include "slam/brain/landmarks/salient_regions.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::apps {

// Not for two threads at once.
class ImageLandmarks {
 public:
  // Throws InputError where the file is not there or holds another network, also one with other classes or
  // another embedding than landmark.h has.
  explicit ImageLandmarks(const std::filesystem::path& weights,
                          const slam::brain::RegionSettings& settings = {});

  // `image` is 8-bit grey or BGR; `landmarks` is overwritten. From the second image of a size on nothing is
  // allocated.
  void operator()(const ByteView& image, slam::brain::Landmarks& landmarks);

 private:
  nn::InterestNetwork network_;
  nn::Arena arena_;
  nn::InterestMap map_;
  slam::brain::SalientRegions regions_;
};

// The landmarks of a frame's left image, as slam::brain::Brain asks for them.
std::function<void(const slam::StereoImages&, slam::brain::Landmarks&)> make_landmark_finder(
    const std::filesystem::path& weights, const slam::brain::RegionSettings& settings = {});

// Adds --weights; the default is the trained weights' place in the source tree, seen from its root.
void add_interest_weights_option(CLI::App* command, std::filesystem::path& weights);

}  // namespace penumbra::apps
