// What a place is known by, as a picture: landmarks with their interest above, ORB features below.
#pragma once

#include "nn/image/image.h"
#include "slam/brain/landmarks/landmark.h"
#include "slam/frontend/features/feature.h"

namespace penumbra::apps {

// A BGR picture of the image's size and twice its height, larger where text could not be read. The more
// interesting a landmark, the wider its box's line; the ten most interesting ones have their class and
// interest beside them.
ByteImage landmark_picture(const ByteImage& image, const slam::brain::Landmarks& landmarks,
                           const slam::Features& features);

}  // namespace penumbra::apps
