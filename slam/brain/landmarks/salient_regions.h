// Salient regions of an image: cells of one class that look like one thing, and what becomes of them.
//
// The interest network says of each cell of a grid its class probabilities p and a unit embedding e. A region
// grows from the surest cell that is left to its four neighbours, and on, by cells
//
//   of the same most probable class, one that stands (landmark.h), with p >= p_0, with
//   p_person + p_vehicle <= q_0, and with  e . m >= c_0
//
// where m is the mean of the region's embeddings so far, made unit length: the front of a house ends where
// the next house begins. A region of at least n_0 cells is a landmark:
//
//   score = mean of p of its class                                              docs/papers.md D.2 (16)
//   descriptor = sum of p e, made unit length;   box = that of its cells, inside of the image
//
// Then touching regions may join, and all get their interest (interest.h). Persons and vehicles are in no
// region, nor is what may be one.
//
// Cost: about 0.1 ms for 78 x 24 cells; no allocation from the second image of a size on.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slam/brain/landmarks/interest.h"
#include "slam/brain/landmarks/landmark.h"

namespace penumbra::slam::brain {

// What a network says of an image. Cell (x, y) shows the pixels from left + x size, top + y size on.
struct ImageCells {
  int width = 0, height = 0;                   // cells
  float left = 0.0F, top = 0.0F, size = 0.0F;  // pixels
  int image_width = 0, image_height = 0;       // pixels
  std::span<const float> probabilities;        // cell by cell, row by row: kLandmarkClasses numbers
  std::span<const float> embeddings;           // the same: kDescriptorSize numbers, unit length
};

struct RegionSettings {
  float least_probability = 0.4F;  // p_0
  float most_moving = 0.2F;        // q_0
  float least_cosine = 0.5F;       // c_0
  int least_cells = 3;             // n_0
  InterestSettings interest;
};

class SalientRegions {
 public:
  explicit SalientRegions(const RegionSettings& settings = {}) : settings_(settings) {}

  // The landmarks of an image, the most interesting first; at most kMostLandmarks.
  void operator()(const ImageCells& cells, Landmarks& landmarks);

 private:
  void classify(const ImageCells& cells);
  // The region of `seed`, whose cells are taken from those that are left.
  void grow(const ImageCells& cells, std::uint32_t seed);
  Landmark landmark(const ImageCells& cells, int landmark_class) const;

  RegionSettings settings_;
  std::vector<std::int8_t> class_of_;  // of each cell; kNothing: no landmark's, or taken
  std::vector<float> probability_of_;  // of its class
  std::vector<std::uint32_t> seeds_;   // the surest first
  std::vector<std::uint32_t> region_;  // the cells of one
  Landmarks found_;
};

}  // namespace penumbra::slam::brain
