// Times that the names of images are.
#pragma once

#include <string>
#include <vector>

#include "slam/datasets/image_pairs.h"

namespace penumbra::slam {

// The seconds of the pairs' left images, where all their names are times: numbers with a point, or whole
// numbers of which the largest has at least 10 digits and which do not just count. Empty where they are not;
// a name such as 20190131123456, a date, is no time. `notes` says which unit was taken. Throws InputError as
// to_seconds does.
std::vector<double> times_in_names(const ImagePairs& images, std::vector<std::string>& notes);

}  // namespace penumbra::slam
