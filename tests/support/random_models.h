// Classifiers and YOLOv5 with random weights: the same as make_classifier_fixtures.py and
// make_yolov5_fixtures.py and make_afnet_fixtures.py build.
#pragma once

#include "nn/io/state_dict.h"

namespace penumbra::test {

// A ResNet of 10 classes whose stem has `width` channels.
nn::StateDict random_resnet(int depth, int width);

struct RandomYolov5 {
  double width = 0.125, depth = 1.0 / 3.0;
  int classes = 3;
  bool masks = false, folded = false;
  bool attention = false, fusion = false;  // AFNET's parts
};
nn::StateDict random_yolov5(const RandomYolov5& options);

}  // namespace penumbra::test
