#include "slam/pipeline/run_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "nn/base/counted.h"
#include "nn/base/quantile.h"

namespace penumbra::slam {

namespace {

constexpr double kLargestBaseline = 3.0;                         // metres
constexpr double kHighestSpeed = 100.0;                          // m/s
constexpr int kFastFrames = 10;                                  // in a row
constexpr int kSuchFrames = 3;                                   // before it is said that images show nothing
constexpr int kFewestFeatures = 50;                              // of a picture with something in it
constexpr double kFewestDepths = 0.05;                           // of the features
constexpr double kLongStep = 5.0;                                // usual steps between two frames
constexpr std::size_t kDepthFrames = 10;                         // before the depths are judged
constexpr int kFramesForShare = 10;                              // before a share of lost ones says anything
constexpr double kNearest = 0.1;                                 // metres
constexpr double kFarthestStereo = 500.0, kFarthestRgbd = 20.0;  // metres
constexpr double kGreyDeviation = 3.0;  // grey levels; a picture with something in it has ten and more

// Whether all pixels have the same grey, give or take noise.
bool is_one_grey(const ByteImage& image) {
  const int channels = image.channels();
  const auto count = static_cast<double>(image.elements()) / channels;
  for (int c = 0; c < channels; ++c) {
    std::uint64_t sum = 0, squares = 0;
    for (std::size_t i = static_cast<std::size_t>(c); i < image.elements();
         i += static_cast<std::size_t>(channels)) {
      const std::uint64_t value = image.data()[i];
      sum += value;
      squares += value * value;
    }
    const double mean = static_cast<double>(sum) / count;
    if (static_cast<double>(squares) / count - mean * mean >= kGreyDeviation * kGreyDeviation) return false;
  }
  return true;
}

bool are_same(const ByteImage& a, const ByteImage& b) {
  return !a.empty() && a.size() == b.size() && a.channels() == b.channels() &&
         std::memcmp(a.data(), b.data(), a.elements()) == 0;
}

const char* text_of(LostReason reason, Sensor sensor) {
  switch (reason) {
    case LostReason::unreadable:
      return "images that cannot be read or are of another size";
    case LostReason::one_grey:
      return "the images are black or of one grey: lens cap, exposure, or 10 or 12 bits in 16-bit files "
             "(--image-bits)?";
    case LostReason::same_images:
      return "left and right are the same image: was one camera copied to both?";
    case LostReason::few_features:
      return "the images show hardly any corner: dark, blurred, or blank walls?";
    case LostReason::few_depths:
      return sensor == Sensor::stereo
                 ? "hardly any feature of the left image is found in the right one: pairs that do not belong "
                   "together, or a calibration that is not theirs?"
                 : "hardly any feature has a depth: depth images that do not belong to the colour images, or "
                   "a "
                   "wrong depth factor?";
    case LostReason::covered:
      return "what moves covers the view";
    case LostReason::time_gap:
      return "the recording has a gap before them";
    case LostReason::no_agreement:
      break;
  }
  return "too few features agree with any pose: steps too large from frame to frame, blur, or a wrong "
         "calibration?";
}

}  // namespace

RunCheck::RunCheck(const StereoCamera& camera, Sensor sensor) : camera_(camera), sensor_(sensor) {
  if (camera.baseline > kLargestBaseline) {
    warn(fmt::format(
        "the baseline is {:.4g} m: is the calibration in millimetres? Lengths of the path and the map "
        "grow with it",
        camera.baseline));
  }
}

void RunCheck::add(const StereoImages& images, const FrameResult& result) {
  if (frames_++ > 0) {
    last_step_ = images.timestamp - last_time_;
    steps_.add(last_step_);
  }
  const bool located = result.tracking.state == TrackingState::tracking;
  if (result.median_depth > 0.0) {
    depths_.add(result.median_depth);
    if (depths_.count() == kDepthFrames) check_depth();
  }
  newest_reason_.clear();
  if (located) {
    check_speed(images.timestamp, result);
  } else {
    note_lost(images.index, reason_of(images, result));
  }
  located_ = located;
  last_time_ = images.timestamp;
  last_place_ = result.T_wc.translation;
}

void RunCheck::add_unreadable(int index) {
  ++frames_;
  note_lost(index, LostReason::unreadable);
  located_ = false;
}

LostReason RunCheck::reason_of(const StereoImages& images, const FrameResult& result) const {
  if (is_one_grey(images.left) || (!images.right.empty() && is_one_grey(images.right)))
    return LostReason::one_grey;
  if (sensor_ == Sensor::stereo && are_same(images.left, images.right)) return LostReason::same_images;
  if (result.features < kFewestFeatures) return LostReason::few_features;
  if (result.stereo_features < kFewestDepths * result.features) return LostReason::few_depths;
  if (result.tracking.state == TrackingState::occluded) return LostReason::covered;
  if (steps_.count() > 1 && last_step_ > kLongStep * quantile_of(steps_.values(), 0.5))
    return LostReason::time_gap;
  return LostReason::no_agreement;
}

void RunCheck::note_lost(int index, LostReason reason) {
  if (lost_++ == 0) first_lost_ = index;
  last_lost_ = index;
  newest_reason_ = text_of(reason, sensor_);
  const int times = ++lost_for_[static_cast<int>(reason)];
  const bool is_of_the_images = reason != LostReason::unreadable && reason < LostReason::covered;
  if (is_of_the_images && times == kSuchFrames)
    warn(fmt::format("{} frames so far, the last is {}: {}", times, index, text_of(reason, sensor_)));
}

void RunCheck::check_speed(double timestamp, const FrameResult& result) {
  const double seconds = timestamp - last_time_;
  const double metres = (result.T_wc.translation - last_place_).norm();
  const bool is_fast = located_ && !result.tracking.starts_submap && metres > kHighestSpeed * seconds;
  fast_ = is_fast ? fast_ + 1 : 0;
  if (fast_ != kFastFrames) return;
  warn(fmt::format(
      "frame {}: the camera moves at {:.4g} m/s for {} frames: are the times in another unit ({:.3g} s "
      "from frame to frame), or is the baseline ({:.4g} m) too large?",
      result.index, metres / seconds, kFastFrames, seconds, camera_.baseline));
}

void RunCheck::check_depth() {
  const double depth = median_depth(), farthest = sensor_ == Sensor::stereo ? kFarthestStereo : kFarthestRgbd;
  if (depth >= kNearest && depth <= farthest) return;
  warn(fmt::format("the median depth of the features is {:.3g} m: {}?", depth,
                   sensor_ == Sensor::stereo ? "is the baseline in metres"
                                             : "is the depth factor right (levels a metre)"));
}

std::vector<std::string> RunCheck::take_warnings() { return std::exchange(warnings_, {}); }

std::string RunCheck::why_lost() const {
  if (lost_ == 0) return {};
  const int* most = std::max_element(lost_for_, lost_for_ + kLostReasons);
  const auto reason = static_cast<LostReason>(most - lost_for_);
  const bool is_half = frames_ >= kFramesForShare && 2 * lost_ > frames_;
  std::string text = fmt::format(
      "{} of {} {} not located ({}){}", lost_, counted(frames_, "frame"), lost_ == 1 ? "was" : "were",
      first_lost_ == last_lost_ ? fmt::format("frame {}", first_lost_)
                                : fmt::format("frames {} to {}", first_lost_, last_lost_),
      is_half ? ", more than half" : "");
  text += *most == lost_ ? ": " : fmt::format("; {} of them: ", *most);
  return text + text_of(reason, sensor_);
}

double RunCheck::median_depth() const { return quantile_of(depths_.values(), 0.5); }

}  // namespace penumbra::slam
