#include "apps/slam/semantics_options.h"

#include <fmt/core.h>

#include <utility>

#include "nn/base/error.h"
#include "slam/pipeline/dynamics_choice.h"
#include "slam/pipeline/setting_fields.h"

namespace penumbra::apps {

namespace {

// As --dynamics has it.
std::string option_word(slam::InstanceMasks masks) {
  return masks == slam::InstanceMasks::dbscan ? "static-points" : slam::word_of(masks);
}

// --dynamics and what belongs to it.
void set_masks(const SlamOptions& options, slam::SemanticsSettings& semantics) {
  slam::DepthMaskSettings& masks = semantics.depth_masks;
  const auto says = [&](const char* name) { return has_a_say(options, name); };
  if (says("--dynamics")) slam::choose_dynamics(options.dynamics, semantics);
  if (says("--foreground")) masks.foreground.mode = slam::value_of(options.foreground, masks.foreground.mode);
  if (says("--repair")) masks.repair.mode = slam::value_of(options.repair, masks.repair.mode);
  if (says("--clusters")) masks.object.mode = slam::value_of(options.clusters, masks.object.mode);
  constexpr int kPaperClusters = 3;  // the paper does not say; 2 always ties
  if (says("--clusters") && masks.object.mode == slam::ClusterMode::paper)
    masks.object.clusters = kPaperClusters;
  if (says("--consistency")) masks.consistency.enabled = options.consistency == "on";
  slam::StaticPointMode& points = semantics.static_points.constraint.mode;
  if (options.given.contains("--static-points")) points = slam::value_of(options.static_points, points);
}

// UsageError for an option that says how masks are made of boxes, where they are not made so.
void require_user_of(const SlamOptions& options, slam::InstanceMasks masks) {
  constexpr std::pair<const char*, slam::InstanceMasks> kUsers[] = {
      {"--repair", slam::InstanceMasks::depth_clusters},
      {"--clusters", slam::InstanceMasks::depth_clusters},
      {"--consistency", slam::InstanceMasks::depth_clusters},
      {"--foreground", slam::InstanceMasks::dbscan}};
  for (const auto& [option, user] : kUsers) {
    if (masks != user && options.given.contains(option))
      throw UsageError(fmt::format("{} is for --dynamics {} only", option, option_word(user)));
  }
}

}  // namespace

void set_segmentation(const std::string& text, slam::SemanticsSettings& semantics) {
  using Mode = slam::SegmentationMode;
  constexpr std::string_view kEvery = "every-";
  if (text == "keyframes" || text == "all" || text == "off") {
    semantics.mode = text == "keyframes" ? Mode::keyframes : text == "all" ? Mode::all : Mode::off;
    return;
  }
  const std::string number = text.rfind(kEvery, 0) == 0 ? text.substr(kEvery.size()) : "";
  const bool is_number =
      !number.empty() && number.size() <= 6 && number.find_first_not_of("0123456789") == number.npos;
  if (!is_number || std::stoi(number) == 0) {
    throw UsageError(
        fmt::format("expected 'keyframes', 'every-N' such as 'every-5', 'all' or 'off', found '{}'", text));
  }
  semantics.mode = Mode::interval;
  semantics.interval = std::stoi(number);
}

bool has_a_say(const SlamOptions& options, const char* name) {
  return options.settings.empty() || options.given.contains(name);
}

void set_semantics(const SlamOptions& options, slam::SemanticsSettings& semantics) {
  const auto says = [&](const char* name) { return has_a_say(options, name); };
  if (says("--segmentation")) set_segmentation(options.segmentation, semantics);
  if (options.least_score) semantics.instances.least_score = *options.least_score;
  set_masks(options, semantics);
  // What follows from --dynamics or --static-points follows beside a file of settings, too.
  if (says("--moving") || options.given.contains("--dynamics") || options.given.contains("--static-points")) {
    const bool by_class =
        options.moving == "class" || (slam::class_decides(semantics) && !options.given.contains("--moving"));
    semantics.instances.check_motion = !by_class;
  }
}

void check_semantics(const SlamOptions& options, const slam::StereoDataset& dataset,
                     const slam::SemanticsSettings& semantics) {
  const slam::InstanceMasks masks = semantics.depth_masks.masks;
  if (semantics.static_points.constraint.mode != slam::StaticPointMode::off && options.weights.empty() &&
      options.masks.empty()) {
    throw UsageError("--static-points: needs --weights or --masks, whose points it gives back");
  }
  require_user_of(options, masks);
  if (masks == slam::InstanceMasks::detector || semantics.mode == slam::SegmentationMode::off) return;
  if (options.weights.empty() && options.masks.empty()) {
    throw UsageError(fmt::format("--dynamics {}: needs --weights, for the boxes of objects (or --masks)",
                                 option_word(masks)));
  }
  if (slam::needs_depth(masks) && dataset.sensor() != slam::Sensor::rgbd) {
    throw UsageError(fmt::format(
        "--dynamics {}: needs an RGB-D recording, and {} is a stereo recording, without depth{}",
        option_word(masks), dataset.name(),
        masks == slam::InstanceMasks::dbscan ? " (--static-points alone works with any masks)" : ""));
  }
}

std::string segmentation_text(const slam::SemanticsSettings& semantics) {
  if (semantics.mode == slam::SegmentationMode::interval) return fmt::format("every-{}", semantics.interval);
  return slam::word_of(semantics.mode);
}

}  // namespace penumbra::apps
