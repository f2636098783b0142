// A stereo or RGB-D drive through the synthetic street.
#pragma once

#include <string>

#include "slam/world/sequence.h"
#include "slam/world/street_builder.h"

namespace penumbra::slam::synthetic {

struct SequenceSettings {
  StreetSettings street = {};
  Sensor sensor = Sensor::stereo;
  std::string path = "block";  // "block", "eight", "straight", "corner" or a KITTI pose file
  int frames = 0;              // 0: 60, or all of a pose file
  Size size{620, 188};         // pixels
  std::uint32_t seed = 1;
  bool annotations = false;  // COCO instances of the left or only image
  // What stereo drives have beyond grey pairs and instance ids; all but `colour` for the left image.
  bool colour = false;
  bool depth = false, disparity = false, flow = false;
  bool amodal = false;     // the objects' whole masks as images
  bool landmarks = false;  // which thing each pixel of the left or only image shows
};

// A camera as KITTI's, scaled to `size`: f = 0.58 width, baseline 0.537 m, principal point near the middle.
StereoCamera street_camera(const Size& size);

class StreetSequence : public Sequence {
 public:
  // Throws UsageError for settings that make no sense, InputError for a bad pose file.
  explicit StreetSequence(const SequenceSettings& settings);
};

}  // namespace penumbra::slam::synthetic
