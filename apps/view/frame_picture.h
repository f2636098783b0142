// A frame with its features and objects, for people to look at.
#pragma once

#include "nn/image/image.h"
#include "slam/pipeline/frame_view.h"

namespace penumbra::apps {

// The left image, grey or BGR, 480 pixels wide, with each feature as a dot: green where it shows a map point,
// red on something that moves, yellow otherwise; and the masks of instances: red moving, orange mostly
// hidden, blue movable but still, green of things that cannot move. About a millisecond.
ByteImage draw_frame(const ByteImage& left, const slam::FrameView& view);

}  // namespace penumbra::apps
