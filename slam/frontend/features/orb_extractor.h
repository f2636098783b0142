// ORB features: FAST corners on an image pyramid, spread evenly, with an orientation and a rotated BRIEF
// descriptor.
//
//   FAST-9 with threshold 20; cells of 35 pixels that stay empty are searched again with threshold 7
//   features of level l:  n_l = N (1 - 1/s) / (1 - 1/s^L) / s^l        (in proportion to the level's width:
//                         its area falls with s^-2l, so that a coarse level holds more features per pixel of
//                         its own)
//   orientation:          angle = atan2(m01, m10),  m_pq = sum x^p y^q I(x, y) over the disc of radius 15
//   descriptor:           bit i = G(a_i) < G(b_i), pattern turned by the angle; G = the level blurred, with
//                         a sigma of 2 pixels
//
// Cost at 1241 x 376 and 2000 features: about 4 ms on one core.
// Source: Rublee et al., ORB: an efficient alternative to SIFT or SURF (ICCV 2011); the pattern is our own
// (slam/frontend/features/orb_pattern.h).
#pragma once

#include <vector>

#include "nn/image/blur.h"
#include "nn/image/fast_corners.h"
#include "slam/frontend/features/feature.h"
#include "slam/frontend/features/image_pyramid.h"
#include "slam/frontend/features/quadtree.h"

namespace penumbra::slam {

struct OrbSettings {
  int features = 0;  // wanted per image; 0: by the image's size, see default_feature_count
  PyramidSettings pyramid;
  int fast_threshold = 20;        // grey values
  int lowest_fast_threshold = 7;  // for cells without a corner
  int cell_size = 35;             // pixels of the level
};

// One feature per 233 pixels (2000 at 1241 x 376), between 1000 and 4000.
int default_feature_count(const Size& image);

// Extracts from one image after another; keeps its buffers. Use one extractor per camera and thread.
class OrbExtractor {
 public:
  explicit OrbExtractor(const OrbSettings& settings) : settings_(settings) {}

  // `grey`: 8-bit, one channel, any size. An image without texture or smaller than a patch has no features.
  // `grey` must stay unchanged as long as pyramid() is used. `more`: times as many features as the
  // settings say, where part of the image is known to be of no use.
  void extract(const ByteImage& grey, Features& features, double more = 1.0);

  // The pyramid of the last image.
  const ImagePyramid& pyramid() const { return pyramid_; }

 private:
  void find_corners(const ByteView& level, const Rect& region);

  OrbSettings settings_;
  ImagePyramid pyramid_;
  // Buffers.
  FastCorners fast_;
  std::vector<Corner> corners_;
  std::vector<char> cell_has_corner_;
  CornerSpreader spreader_;
  GaussianBlur blur_;
  ByteImage blurred_;
};

}  // namespace penumbra::slam
