// Times and frame numbers that the names of images hold.
//
// A name is PREFIX NUMBER SUFFIX, or PREFIX SECONDS_NANOSECONDS SUFFIX as ROS's tools write it, with the same
// prefix and suffix in all names; either may be empty. Names count that are those of pairs.
#pragma once

#include <string>
#include <vector>

#include "slam/sources/image_pairs.h"

namespace penumbra::slam {

// The seconds of the pairs' left images, where all their names are times: numbers with a point and nothing
// else, whole numbers or numbers with a point of which the largest has at least 10 digits before it and which
// do not just count, or 1403636570_763555580 (nanoseconds of 7 to 9 digits, or microseconds of 6). Empty
// where they are not; a name such as 20190131123456, a date, is no time. `notes` says which unit was taken,
// or why names that look like times are none. Throws InputError as to_seconds does.
std::vector<double> times_in_names(const ImagePairs& images, std::vector<std::string>& notes);

// The place of each pair among the frames that the camera took, from 0 on: by the numbers in the names, where
// these are frame numbers (below 10^9) that rise by multiples of their usual step, so that a frame which is
// in neither folder leaves a gap; else the place of the name.
std::vector<double> places_in_names(const ImagePairs& images);

}  // namespace penumbra::slam
