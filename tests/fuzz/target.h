// Fuzz targets: readers that are given bytes from anywhere, by libFuzzer (tests/fuzz/run) or from the saved
// corpus (corpus_test.cpp).
//
// A reader may do two things with any bytes: return what they hold, or throw a penumbra::Error whose message
// can be shown. Whatever else happens, such as another exception, a sanitizer's report, a hang or a broken
// promise about what was returned, is a finding.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "nn/base/error.h"

namespace penumbra::fuzz {

struct Target {
  const char* name;                      // also its folder in tests/fuzz/corpus
  bool (*read)(std::string_view bytes);  // false where the bytes were refused with an Error
};

std::span<const Target> all_targets();
const Target& target_named(std::string_view name);  // throws std::out_of_range

// A finding that no sanitizer sees.
class BrokenPromise : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

inline void require(bool holds, const std::string& promise) {
  if (!holds) throw BrokenPromise("broken promise: " + promise);
}

// Throws BrokenPromise unless an error's message is one line of UTF-8 without control characters, of bounded
// length: it goes to terminals, and names and words from the file are in it.
void require_showable(std::string_view message);

// Whether `read` returns; false where it throws an Error with a message that can be shown.
template <class Read>
bool is_read(const Read& read) {
  try {
    read();
    return true;
  } catch (const Error& error) {
    require_showable(error.what());
    return false;
  }
}

// The targets; see the files in tests/fuzz/targets.
bool read_pickle(std::string_view bytes);
bool read_torch_zip(std::string_view bytes);
bool read_torch_legacy(std::string_view bytes);
bool read_safetensors(std::string_view bytes);
bool read_coco_rle(std::string_view bytes);
bool read_image_container(std::string_view bytes);
bool read_image_file(std::string_view bytes);
bool read_number_file(std::string_view bytes);
bool read_kitti_calibration(std::string_view bytes);
bool read_trajectory(std::string_view bytes);
bool read_class_names(std::string_view bytes);
bool read_frame_range(std::string_view bytes);
bool read_coco_annotations(std::string_view bytes);
bool read_coco_results(std::string_view bytes);
bool read_map_file(std::string_view bytes);
bool read_cognitive_map_file(std::string_view bytes);
bool read_odometry_file(std::string_view bytes);
bool read_plan_file(std::string_view bytes);
bool read_camera_file(std::string_view bytes);
bool read_image_list(std::string_view bytes);
bool read_euroc_ground_truth(std::string_view bytes);
bool read_recording(std::string_view bytes);
bool read_message(std::string_view bytes);

}  // namespace penumbra::fuzz
