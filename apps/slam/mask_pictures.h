// The steps from a box to a mask as one picture, side by side: the image, its depth, the repaired depth, the
// clusters of depths, the mask, and the corners, red where the mask takes them away.
#pragma once

#include "slam/dynamics/rgbd/object_in_box.h"

namespace penumbra::apps {

// `depth`, `repaired`: metres, 0 where unknown (drawn dark red); near is bright. `mask`: of the box.
ByteImage mask_steps(const ByteImage& image, const FloatImage& depth, const FloatImage& repaired,
                     const Rect& box, const slam::ObjectMask& mask);

}  // namespace penumbra::apps
