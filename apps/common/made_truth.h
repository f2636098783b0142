// What `penumbra synth` writes beside a recording and judges compare with: who the instances are, and the
// depth without noise.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "nn/image/image.h"

namespace penumbra::apps {

struct MadeInstance {
  std::string class_name;
  bool moves = false;  // false where the list does not say
};

// instances.json, {"17": {"class": "car", "moving": false}, ...}. Throws InputError for anything else.
std::map<int, MadeInstance> read_instance_list(const std::filesystem::path& path);

// The true depth of an RGB-D recording, frame by frame.
class TrueDepths {
 public:
  // `images`: folder of its images, the i-th in the order of their names that of frame i, coded as
  // `recording` codes its depth (depth_factor of calibration.yaml). Throws InputError where one of them is
  // not there.
  TrueDepths(const std::filesystem::path& recording, const std::filesystem::path& images);

  bool has(int frame) const { return frame >= 0 && frame < static_cast<int>(files_.size()); }
  const std::filesystem::path& file(int frame) const { return files_[static_cast<std::size_t>(frame)]; }
  // Metres, 0 = none. Throws InputError for an image that is not of that size.
  FloatImage load(int frame, const Size& size) const;

 private:
  std::vector<std::filesystem::path> files_;
  double levels_a_metre_ = 0.0;
};

}  // namespace penumbra::apps
