// Which features lie on things that can move by themselves, so that neither pose nor map may rely on them.
#pragma once

#include <string_view>
#include <vector>

#include "slam/features/feature.h"
#include "slam/semantics/instance.h"

namespace penumbra::slam {

// People, vehicles and animals, by the class names of COCO and Cityscapes ("person", "rider", "car", "dog",
// ...), whatever their case. A parked car is movable, too: this is about what a thing can do.
bool is_movable_class(std::string_view class_name);

// Marks (1) the features on instances of movable classes with at least `least_score`. Masks end a little
// inside their object: features within `margin` pixels of one belong to it. `movable` has one entry per
// keypoint; marks that it holds stay.
void mark_movable_features(const std::vector<Instance>& instances, const std::vector<Keypoint>& keypoints,
                           double least_score, int margin, std::vector<char>& movable);

}  // namespace penumbra::slam
