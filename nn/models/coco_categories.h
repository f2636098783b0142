// COCO's numbering of its 80 categories: 1 to 90 with ten gaps, categories that were planned and never
// annotated. Detectors number their outputs either with the gaps (torchvision: 91 with the background) or
// without (YOLO: 80).
// Source: Lin et al. 2014, Microsoft COCO; instances_val2017.json.
#pragma once

#include <array>

namespace penumbra::nn {

constexpr int kCocoClasses = 80;
constexpr std::array<int, 10> kUnusedCocoCategories{12, 26, 29, 30, 45, 66, 68, 69, 71, 83};

// Label of output `c` (0..classes - 1) of a network without a background class: COCO's number where it has
// COCO's 80 classes, else c + 1.
constexpr int category_of_class(int c, int classes) {
  int category = c + 1;
  if (classes != kCocoClasses) return category;
  for (const int unused : kUnusedCocoCategories) {
    if (unused <= category) ++category;
  }
  return category;
}

static_assert(category_of_class(79, kCocoClasses) == 90);

}  // namespace penumbra::nn
