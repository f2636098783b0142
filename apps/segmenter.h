// The network as the SLAM's segmenter.
#pragma once

#include <filesystem>

#include "slam/semantics/instance.h"

namespace penumbra::apps {

// Loads the weights once; the segmenter keeps the network, Mask R-CNN or YOLOv5. Throws InputError where it
// finds boxes without masks. `classes` as in nn/models/class_names.h, may be
// empty.
slam::Segmenter load_segmenter(const std::filesystem::path& weights, const std::filesystem::path& classes);

}  // namespace penumbra::apps
