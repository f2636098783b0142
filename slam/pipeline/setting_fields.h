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
               RepairMode*, ClusterMode*, ForegroundMode*, StaticPointMode*>
      value;
  double least = 0.0, most = 0.0;  // of numbers
  bool or_zero = false;            // 0 is allowed beside them
};

// All fields of `settings`, which must outlive them, in the order of SlamSettings. Left out is what
// Slam derives from the camera and other settings (Slam::settings(): close_depth, threads of bundle
// adjustments, extends_map).
std::vector<SettingField> setting_fields(SlamSettings& settings);

// The words of the settings that are no numbers.
template <class Mode>
using Word = std::pair<std::string_view, Mode>;
template <class Mode>
inline constexpr std::array<Word<Mode>, 0> kWords{};
template <>
inline constexpr auto kWords<MismatchFilterMode> =
    std::to_array<Word<MismatchFilterMode>>({{"off", MismatchFilterMode::off},
                                             {"paper", MismatchFilterMode::paper},
                                             {"adaptive", MismatchFilterMode::adaptive},
                                             {"compensated", MismatchFilterMode::compensated}});
template <>
inline constexpr auto kWords<SegmentationMode> =
    std::to_array<Word<SegmentationMode>>({{"off", SegmentationMode::off},
                                           {"keyframes", SegmentationMode::keyframes},
                                           {"interval", SegmentationMode::interval},
                                           {"all", SegmentationMode::all}});

template <>
inline constexpr auto kWords<InstanceMasks> =
    std::to_array<Word<InstanceMasks>>({{"masks", InstanceMasks::detector},
                                        {"depth-clusters", InstanceMasks::depth_clusters},
                                        {"dbscan", InstanceMasks::dbscan},
                                        {"boxes", InstanceMasks::boxes}});
template <>
inline constexpr auto kWords<RepairMode> = std::to_array<Word<RepairMode>>({{"off", RepairMode::off},
                                                                            {"paper", RepairMode::paper},
                                                                            {"border", RepairMode::border},
                                                                            {"median", RepairMode::median},
                                                                            {"modes", RepairMode::modes}});
template <>
inline constexpr auto kWords<ClusterMode> = std::to_array<Word<ClusterMode>>({{"paper", ClusterMode::paper},
                                                                              {"grown", ClusterMode::grown}});
template <>
inline constexpr auto kWords<ForegroundMode> = std::to_array<Word<ForegroundMode>>(
    {{"paper", ForegroundMode::paper}, {"adaptive", ForegroundMode::adaptive}});
template <>
inline constexpr auto kWords<StaticPointMode> =
    std::to_array<Word<StaticPointMode>>({{"off", StaticPointMode::off},
                                          {"paper", StaticPointMode::paper},
                                          {"adaptive", StaticPointMode::adaptive}});

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
