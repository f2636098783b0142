// Where the depth of a feature comes from: a second image, or a depth map of the first.
#pragma once

namespace penumbra::slam {

enum class Sensor { stereo, rgbd };

}  // namespace penumbra::slam
