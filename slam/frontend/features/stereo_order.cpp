#include "slam/frontend/features/stereo_order.h"

#include "nn/base/error.h"

namespace penumbra::slam {

namespace {

constexpr int kFewestFeatures = 100;
constexpr int kFewestMatches = 50;  // that tell anything
constexpr double kGoodShare = 0.3;  // of the features: the pair is as it should be
constexpr int kTimesAsMany = 3;     // matches with the images exchanged

}  // namespace

void StereoOrder::check(int index, const StereoCamera& camera, const Features& left, const Features& right,
                        const ImagePyramid& left_pyramid, const ImagePyramid& right_pyramid,
                        const StereoMatches& matches) {
  if (settled_ || left.size() < kFewestFeatures) return;
  if (matches.count >= kFewestMatches && matches.count >= kGoodShare * left.size()) {
    settled_ = true;
    return;
  }
  StereoMatches exchanged;
  match_stereo(camera, right, left, right_pyramid, left_pyramid, exchanged);
  if (exchanged.count < kFewestMatches) return;
  if (exchanged.count < kTimesAsMany * matches.count) {
    settled_ = matches.count > exchanged.count;
    return;
  }
  if (++votes_ < kVotes) return;
  throw InputError(
      fmt::format("frame {}", index), "the left camera's image, then the right one's",
      fmt::format("{} of {} features that match as the images are given, but {} of {} with left and right "
                  "exchanged: exchange the images, or the sign of the baseline",
                  matches.count, left.size(), exchanged.count, right.size()));
}

}  // namespace penumbra::slam
