// Which things can move by themselves, by the names of their classes.
#pragma once

#include <string_view>

namespace penumbra::slam {

// People, vehicles and animals, by the class names of COCO and Cityscapes ("person", "rider", "car", "dog",
// ...), whatever their case. A parked car is movable, too: this is about what a thing can do.
bool is_movable_class(std::string_view class_name);

// Cars, bicycles, boats and the like: what can move, but stands where it was left. Whatever its case.
bool is_vehicle_class(std::string_view class_name);

// Log odds that an instance of the class moves, before anything else is known of it: people, riders and
// animals usually do, vehicles as often as not, other things hardly ever.
double moving_prior(std::string_view class_name);

}  // namespace penumbra::slam
