// Image classification with a plain ResNet: one score for every class.
//
//   logits = W mean_{i, j} C5[:, i, j] + b;   probabilities = softmax(logits)
//
// The weights decide depth, width and the number of classes. Source: He et al. 2016;
// torchvision.models.resnet.
#pragma once

#include <string>
#include <vector>

#include "nn/image/image.h"
#include "nn/io/crop_transform.h"
#include "nn/models/resnet.h"

namespace penumbra::nn {

struct ClassifierConfig {
  CropTransform transform;
  float batch_norm_eps = 1e-5F;
};

class Classifier {
 public:
  // Metadata "batch_norm_eps" of the weights replace the config's. Throws InputError that lists every tensor
  // that is missing, mis-shaped, not finite or not part of the network.
  explicit Classifier(const StateDict& weights, ClassifierConfig config = {});

  std::string name() const;
  int classes() const { return head_.output_channels(); }

  // The logits. `image` is 8-bit grey or BGR of any size, not empty. Activations live in `arena`, nothing in
  // the network changes.
  std::vector<float> operator()(const ByteView& image, Arena& arena) const {
    std::vector<float> logits;
    (*this)(image, arena, logits);
    return logits;
  }
  // The same into `logits`, whose memory is used again: from the second image of a shape on nothing is
  // allocated.
  void operator()(const ByteView& image, Arena& arena, std::vector<float>& logits) const;

 private:
  ClassifierConfig config_;
  ResNet backbone_;
  Conv2d head_;
};

// The `count` classes of the best logits, best first (all where there are fewer; equal ones in order).
std::vector<int> best_classes(const std::vector<float>& logits, int count);

}  // namespace penumbra::nn
