#include "slam/evaluation/matching_evaluation.h"

#include <algorithm>
#include <cmath>

#include "nn/base/stopwatch.h"
#include "nn/image/grey.h"
#include "slam/frontend/features/depth_measurement.h"
#include "slam/frontend/features/descriptor_matcher.h"
#include "slam/frontend/features/orb_extractor.h"
#include "slam/frontend/features/stereo_matcher.h"
#include "slam/geometry/triangulation.h"

namespace penumbra::slam {

namespace {

constexpr double kStill = 0.01;  // metres

Eigen::Matrix3d intrinsics(const StereoCamera& camera) {
  Eigen::Matrix3d K;
  K << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  return K;
}

std::vector<float> depths_of(const StereoCamera& camera, const StereoImages& images, const Features& left,
                             const ImagePyramid& left_pyramid, const OrbSettings& orb) {
  StereoMatches stereo;
  if (!images.depth.empty()) {
    measure_depth(camera, left, images.depth, stereo);
  } else if (!images.right.empty()) {
    const ByteImage grey = to_grey(images.right);
    OrbExtractor extractor(orb);
    Features right;
    extractor.extract(grey, right);
    match_stereo(camera, left, right, left_pyramid, extractor.pyramid(), stereo);
  } else {
    stereo.depth.assign(left.keypoints.size(), -1.0F);
  }
  return stereo.depth;
}

MismatchFilterMode filter_of(MatchingMethod method) {
  switch (method) {
    case MatchingMethod::orb_paper:
      return MismatchFilterMode::paper;
    case MatchingMethod::orb_adaptive:
      return MismatchFilterMode::adaptive;
    case MatchingMethod::orb_compensated:
      return MismatchFilterMode::compensated;
    default:
      return MismatchFilterMode::off;
  }
}

}  // namespace

// The features of an image.
struct MatchingEvaluation::Image {
  SE3 T_wc;
  double timestamp = 0.0;  // seconds
  Features orb;
  std::vector<float> depth;  // of `orb`, metres; -1 where unknown
  double orb_ms = 0.0;
};

const char* name_of(MatchingMethod method) {
  switch (method) {
    case MatchingMethod::baseline:
      return "baseline";
    case MatchingMethod::orb:
      return "ORB";
    case MatchingMethod::orb_paper:
      return "ORB + paper filter";
    case MatchingMethod::orb_adaptive:
      return "ORB + adaptive filter";
    case MatchingMethod::orb_compensated:
      break;
  }
  return "ORB + compensated filter";
}

MotionCheck::MotionCheck(const StereoCamera& camera, const SE3& T_21)
    : still_(T_21.translation.norm() < kStill) {
  const Eigen::Matrix3d K = intrinsics(camera);
  H_ = K * T_21.rotation * K.inverse();
  F_ = fundamental_matrix(camera, SE3{}, T_21);
}

double MotionCheck::distance(const Eigen::Vector2d& first, const Eigen::Vector2d& second) const {
  if (still_) return ((H_ * first.homogeneous()).hnormalized() - second).norm();
  return std::sqrt(std::max(squared_epipolar_distance(F_, first, second),
                            squared_epipolar_distance(F_.transpose(), second, first)));
}

MatchingEvaluation::MatchingEvaluation(const StereoCamera& camera, const MatchingSettings& settings)
    : camera_(camera), settings_(settings), baseline_(settings.baseline ? settings.baseline() : nullptr) {}

MatchingEvaluation::~MatchingEvaluation() = default;

// Each other's nearest descriptors in the image before and `now`, and where the ones before were expected.
std::vector<MatchedPixels> MatchingEvaluation::match_orb(const Image& now) const {
  DescriptorMatcherSettings plain;  // the filter is to do the work
  plain.max_distance = kDescriptorBits;
  plain.ratio = 1.0F;
  const SE3 T_before_w = before_->T_wc.inverse();
  const SE3 T_21 = motion_.predict(T_before_w, before_->timestamp, now.timestamp) * before_->T_wc;
  std::vector<MatchedPixels> pairs;
  for (const Match& m : match_descriptors(before_->orb.descriptors, now.orb.descriptors, plain)) {
    const Keypoint& a = before_->orb.keypoints[static_cast<std::size_t>(m.source)];
    const Keypoint& b = now.orb.keypoints[static_cast<std::size_t>(m.feature)];
    pairs.push_back({{a.u, a.v}, {b.u, b.v}});
    const double depth = before_->depth[static_cast<std::size_t>(m.source)];
    if (!motion_.known() || !(depth > 0.0)) continue;
    const Eigen::Vector3d p = T_21 * camera_.back_project(a.u, a.v, depth);
    if (p.z() > 0.0) pairs.back().expected = camera_.project(p).cast<float>();
  }
  return pairs;
}

void MatchingEvaluation::add(const StereoImages& images, const SE3& T_wc) {
  auto now = std::make_unique<Image>();
  now->T_wc = T_wc;
  now->timestamp = images.timestamp;
  const ByteImage grey = to_grey(images.left);
  OrbSettings orb;
  orb.features = settings_.orb_features;
  OrbExtractor extractor(orb);
  {
    const Stopwatch watch;
    extractor.extract(grey, now->orb);
    now->orb_ms = watch.milliseconds();
  }
  now->depth = depths_of(camera_, images, now->orb, extractor.pyramid(), orb);
  MatchingBaseline::Pairs others;
  if (baseline_) others = baseline_->match(grey);
  if (before_) {
    const MotionCheck check(camera_, now->T_wc.inverse() * before_->T_wc);
    const Stopwatch watch;
    const std::vector<MatchedPixels> pairs = match_orb(*now);
    const double match_ms = watch.milliseconds();
    for (const MatchingMethod method : {MatchingMethod::orb, MatchingMethod::orb_paper,
                                        MatchingMethod::orb_adaptive, MatchingMethod::orb_compensated}) {
      add_pairs(method, pairs, check, now->orb_ms, match_ms);
    }
    motion_.observe(now->T_wc.inverse(), before_->T_wc.inverse(), before_->timestamp, now->timestamp);
    if (!others.pixels.empty()) {
      add_pairs(MatchingMethod::baseline, others.pixels, check, others.extract_ms, others.match_ms);
    }
  }
  before_ = std::move(now);
}

void MatchingEvaluation::add_pairs(MatchingMethod method, const std::vector<MatchedPixels>& pairs,
                                   const MotionCheck& check, double extract_ms, double match_ms) {
  MismatchFilterSettings settings;
  settings.mode = filter_of(method);
  std::vector<char> keep;
  MatchingCounts& counts = counts_[static_cast<std::size_t>(method)];
  const Stopwatch watch;
  filter_mismatches(pairs, settings, keep);
  if (settings.mode != MismatchFilterMode::off) counts.filter_ms += watch.milliseconds();
  counts.extract_ms += extract_ms;
  counts.match_ms += match_ms;
  ++counts.images;
  auto& bins = histograms_[static_cast<std::size_t>(method)].bins;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const bool effective =
        check.distance(pairs[i].first.cast<double>(), pairs[i].second.cast<double>()) < settings_.threshold;
    counts.pairs += keep[i];
    counts.effective += keep[i] && effective;
    const double moved = (pairs[i].first - pairs[i].second).norm();
    auto& bin =
        bins[static_cast<std::size_t>(std::min(moved / DisplacementHistogram::kWidth, bins.size() - 1.0))];
    ++(effective ? (keep[i] ? bin.effective_kept : bin.effective_removed)
                 : (keep[i] ? bin.wrong_kept : bin.wrong_removed));
  }
}

}  // namespace penumbra::slam
