// What a keyframe contributes to the dense map: its depth, colours and classes, at a part of the image's
// size.
//
// Kept per view: 2 bytes of depth, 3 of colour and 1 of class a pixel; with 640 x 480 pixels and a step of 2,
// 460 kB.
#pragma once

#include <cstdint>

#include "nn/image/image.h"
#include "slam/geometry/stereo_camera.h"

namespace penumbra::slam {

// What must not become part of the map; other numbers are classes, 0 is none.
constexpr std::uint8_t kMoves = 255;

struct DenseView {
  StereoCamera camera;  // of the small images
  WordImage depth;      // depth_units a metre; 0: none
  ByteImage colour;     // blue, green, red
  ByteImage label;      // class, or kMoves
  int step = 1;         // pixels of the image to one of the view
  float depth_units = kDepthUnits;

  static constexpr float kDepthUnits = 5000.0F;  // of what is seen up to 13 m away

  std::size_t bytes() const { return depth.elements() * 2 + colour.elements() + label.elements(); }
  float depth_at(int column, int row) const {
    return static_cast<float>(depth.at(column, row)) / depth_units;
  }
};

// How depth is taken over.
struct DepthCoding {
  float units = DenseView::kDepthUnits;  // a metre; depth beyond 65535 of them counts as that
  float jump = 0.05F;                    // share of the depth: more between neighbours is a jump ...
  float least_jump = 0.0F;               // ... where 1 / depth changes by more than this, too, 1/metres
};

// Takes every `step`-th pixel of a frame. Depth at a jump is left out: pixels there mix two surfaces.
// `image`: grey or blue, green, red, of the depth's size.
DenseView make_dense_view(const StereoCamera& camera, const ByteImage& image, const FloatImage& depth,
                          int step, const DepthCoding& coding = {});

// For a view from a pair of images whose disparity turns out to have another offset than was thought
// (StereoCamera): its depths become what they are with `offset`, pixels of the view.
//
//   fx b / z' = fx b / z + before - offset
void correct_disparity_offset(DenseView& view, double offset);

// The least depth of a pixel and its eight neighbours, metres: nothing is nearer there. 0 where that is not
// known: the pixel has no depth, or is at the border, or fewer than five of the nine have one.
float nearest_depth(const DenseView& view, int column, int row);
FloatImage nearest_depths(const DenseView& view);  // of all its pixels

// Gives the pixels of a mask (255 = object), `region` in pixels of the whole image and the mask of any size
// stretched over it, the label `label`; `grow` is how far around the mask, in pixels of the whole image, it
// reaches.
void set_label(DenseView& view, const Rect& region, const ByteImage& mask, std::uint8_t label, int grow);

}  // namespace penumbra::slam
