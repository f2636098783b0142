// What all makers of masks from a detector's boxes do before and where depth says nothing.
#pragma once

#include <vector>

#include "slam/dynamics/instance.h"

namespace penumbra::slam {

// Cuts the boxes off at the image's border; leaves out those wholly outside, and those below `least_score`.
void keep_inside(const Size& image, double least_score, std::vector<Instance>& instances);

// All of its box becomes its mask.
void take_whole_box(Instance& instance);

// InputError unless the depth, if there is one, has the image's size and one channel.
void check_depth_size(const ImageToSegment& from);

}  // namespace penumbra::slam
