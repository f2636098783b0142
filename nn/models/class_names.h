// What a detector's class numbers are called.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nn/io/state_dict.h"

namespace penumbra::nn {

// One name a class, index = class number, 0 the background. The first of these that there is:
//   `file` (may be empty): one name a line. Of a network with a background class its line may be left out; of
//   one without (YOLO) it may stand only as the first, under that name
//   metadata "classes" of the weights: the same, separated by line breaks or, in one line, by commas
//   COCO's 91 names where the network has 91 classes
//   "class 1", "class 2", ...
// Where there are 91 classes, a list of 80 names goes to the numbers that COCO uses.
// Throws InputError where a list does not have one name a class, or a name is longer than 120 bytes or no
// plain UTF-8 (names go to terminals and into JSON).
std::vector<std::string> class_names(const StateDict& weights, int classes, const std::filesystem::path& file,
                                     bool has_background = true);

// The same for a classifier, which has no background: one name an output, index = output. There is no
// built-in list; the last resort is "class 0", "class 1", ...
std::vector<std::string> output_names(const StateDict& weights, int outputs,
                                      const std::filesystem::path& file);

}  // namespace penumbra::nn
