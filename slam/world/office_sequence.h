// An RGB-D camera in the synthetic office.
#pragma once

#include "slam/world/office_settings.h"
#include "slam/world/sequence.h"

namespace penumbra::slam::synthetic {

constexpr double kOfficeRate = 30.0;  // frames a second

// A camera as that of TUM's freiburg3, scaled to `size`: fx 535.4, fy 539.2, cx 320.1, cy 247.6 at 640x480.
StereoCamera office_camera(const Size& size);

class OfficeSequence : public Sequence {
 public:
  // Throws UsageError for settings that make no sense, InputError for a bad pose file.
  explicit OfficeSequence(const OfficeSettings& settings);
};

}  // namespace penumbra::slam::synthetic
