// Every setting of the pipeline by name, with its unit and its bounds: what settings files (settings_file.h)
// read and write, and what is checked.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "slam/pipeline/slam.h"

namespace penumbra::slam {

struct SettingField {
  std::string name;  // such as "tracker.search_radius"
  const char* unit;  // "pixels", "metres", "" for a plain number or a switch
  std::variant<bool*, int*, float*, double*, MismatchFilterMode*, SegmentationMode*, InstanceMasks*,
               RepairMode*, ClusterMode*>
      value;
  double least = 0.0, most = 0.0;  // of numbers
};

// All fields of `settings`, which must outlive them, in the order of SlamSettings. Left out is what
// Slam derives from the camera and other settings (Slam::settings(): close_depth, threads of bundle
// adjustments, extends_map).
std::vector<SettingField> setting_fields(SlamSettings& settings);

// The words of the settings that are no numbers.
template <class Mode>
inline constexpr std::array<std::pair<std::string_view, Mode>, 0> kWords{};
template <>
inline constexpr std::array kWords<MismatchFilterMode>{
    std::pair<std::string_view, MismatchFilterMode>("off", MismatchFilterMode::off),
    std::pair<std::string_view, MismatchFilterMode>("paper", MismatchFilterMode::paper),
    std::pair<std::string_view, MismatchFilterMode>("adaptive", MismatchFilterMode::adaptive),
    std::pair<std::string_view, MismatchFilterMode>("compensated", MismatchFilterMode::compensated)};
template <>
inline constexpr std::array kWords<SegmentationMode>{
    std::pair<std::string_view, SegmentationMode>("off", SegmentationMode::off),
    std::pair<std::string_view, SegmentationMode>("keyframes", SegmentationMode::keyframes),
    std::pair<std::string_view, SegmentationMode>("interval", SegmentationMode::interval),
    std::pair<std::string_view, SegmentationMode>("all", SegmentationMode::all)};

template <>
inline constexpr std::array kWords<InstanceMasks>{
    std::pair<std::string_view, InstanceMasks>("masks", InstanceMasks::detector),
    std::pair<std::string_view, InstanceMasks>("depth-clusters", InstanceMasks::depth_clusters),
    std::pair<std::string_view, InstanceMasks>("boxes", InstanceMasks::boxes)};
template <>
inline constexpr std::array kWords<RepairMode>{
    std::pair<std::string_view, RepairMode>("off", RepairMode::off),
    std::pair<std::string_view, RepairMode>("paper", RepairMode::paper),
    std::pair<std::string_view, RepairMode>("border", RepairMode::border),
    std::pair<std::string_view, RepairMode>("median", RepairMode::median),
    std::pair<std::string_view, RepairMode>("modes", RepairMode::modes)};
template <>
inline constexpr std::array kWords<ClusterMode>{
    std::pair<std::string_view, ClusterMode>("paper", ClusterMode::paper),
    std::pair<std::string_view, ClusterMode>("grown", ClusterMode::grown)};

// The value of a word that kWords has.
template <class Mode>
Mode value_of(std::string_view text, Mode otherwise) {
  for (const auto& [word, value] : kWords<Mode>) {
    if (word == text) return value;
  }
  return otherwise;
}

template <class Mode>
std::string word_of(Mode mode) {
  for (const auto& [word, value] : kWords<Mode>) {
    if (value == mode) return std::string(word);
  }
  return {};
}

// Throws InputError(place, ...) for the first number that is out of its bounds or not finite.
void check_settings(const SlamSettings& settings, const std::string& place);

}  // namespace penumbra::slam
