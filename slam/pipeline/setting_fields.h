// Every setting of the pipeline by name, with its unit and its bounds: what settings files (settings_file.h)
// read and write, and what is checked.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "slam/pipeline/slam.h"

namespace penumbra::slam {

struct SettingField {
  std::string name;  // such as "tracker.search_radius"
  const char* unit;  // "pixels", "metres", "" for a plain number or a switch
  std::variant<bool*, int*, float*, double*, MismatchFilterMode*, SegmentationMode*> value;
  double least = 0.0, most = 0.0;  // of numbers
};

// All fields of `settings`, which must outlive them, in the order of SlamSettings. Left out is what
// Slam derives from the camera and other settings (Slam::settings(): close_depth, threads of bundle
// adjustments, extends_map).
std::vector<SettingField> setting_fields(SlamSettings& settings);

// Words of the settings that are none: "off", "adaptive", ...
std::string word_of(MismatchFilterMode mode);
std::string word_of(SegmentationMode mode);
std::vector<std::string> filter_words();
std::vector<std::string> segmentation_words();

// Throws InputError(place, ...) for the first number that is out of its bounds or not finite.
void check_settings(const SlamSettings& settings, const std::string& place);

}  // namespace penumbra::slam
