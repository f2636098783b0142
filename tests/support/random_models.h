// Classifiers, YOLOv5 and interest networks with random weights: the same as make_classifier_fixtures.py,
// make_yolov5_fixtures.py, make_afnet_fixtures.py and make_interest_fixtures.py build.
#pragma once

#include <array>

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

struct RandomInterest {
  std::array<int, 4> channels{8, 16, 16, 24};  // at strides 2, 4, 8, 16
  int classes = 11, embedding = 32;
  bool attention = true, folded = false;
};
nn::StateDict random_interest(const RandomInterest& options = {});

}  // namespace penumbra::test
