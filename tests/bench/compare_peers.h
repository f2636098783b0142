// The network beside ONNX Runtime and PyTorch, where a Python has them.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace penumbra {

struct PeerComparison {
  std::vector<std::string> pythons;  // interpreters; the first that has a module is taken
  int repeats = 5, threads = 1;
  std::function<void()> backbone, full;  // ours
  double first_image_seconds = 0.0;      // of our process, of the processor
};

// By engine: the versions, milliseconds of the processor of both, and ratios ours / theirs, the runs taking
// turns; or what is missing. "torch" has "start_ratio", too: the processor's time of whole processes up to
// the first detections.
nlohmann::ordered_json compare_peers(const PeerComparison& comparison);

}  // namespace penumbra
