// How good feature matching is, with and without the mismatch filter: Table 3 of Jiang, Chen, Yuan (2022).
//
// Features of one image against those of the next, each other's nearest descriptors, no prediction and no
// other test. A pair is *effective* if it agrees with the true motion T_21 = [R | t] between the images:
//
//   max( d(x2, F x1), d(x1, F^T x2) ) < threshold       F = K^-T [t]x R K^-1,  d: distance from the line
//
// (the paper does not say what it calls effective). Where the camera hardly moved there are no epipolar
// lines, and x2 is compared with K R K^-1 x1 instead.
//
// The compensated filter is told what the tracker would know, not the true motion: that the camera goes on as
// it did between the two images before (slam/frontend/locating/motion_model.h), and the features' stereo
// depth. The first two images have no motion before them; there, and where a feature has no depth, it has no
// more to go by than the adaptive one.
//
// Another kind of feature can be measured beside ours (MatchingBaseline). The target penumbra-sift has
// OpenCV's SIFT, which stands in for the paper's SURF, patented in part and not in Debian's OpenCV: both are
// blobs of a scale space with a descriptor of gradients.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "nn/image/image.h"
#include "slam/frontend/features/mismatch_filter.h"
#include "slam/frontend/locating/motion_model.h"
#include "slam/geometry/se3.h"
#include "slam/geometry/stereo_camera.h"
#include "slam/sources/stereo_dataset.h"

namespace penumbra::slam {

enum class MatchingMethod { baseline, orb, orb_paper, orb_adaptive, orb_compensated };
// The baseline has a name of its own.
const char* name_of(MatchingMethod method);
inline constexpr std::array kMatchingMethods = {MatchingMethod::baseline, MatchingMethod::orb,
                                                MatchingMethod::orb_paper, MatchingMethod::orb_adaptive,
                                                MatchingMethod::orb_compensated};
// Features of another kind, compared with ours.
class MatchingBaseline {
 public:
  struct Pairs {
    std::vector<MatchedPixels> pixels;  // first: in the image before
    double extract_ms = 0.0, match_ms = 0.0;
  };
  virtual ~MatchingBaseline() = default;
  virtual std::string name() const = 0;
  // The pairs of the next image (8-bit grey) with the one before; none for the first one of a sequence.
  virtual Pairs match(const ByteView& grey) = 0;
};
using BaselineMaker = std::function<std::unique_ptr<MatchingBaseline>()>;  // one for each sequence

struct MatchingSettings {
  double threshold = 2.0;   // pixels
  int orb_features = 1000;  // per image
  BaselineMaker baseline;   // none where empty
};

// Sums over image pairs.
struct MatchingCounts {
  int images = 0, pairs = 0, effective = 0;
  double extract_ms = 0.0, match_ms = 0.0, filter_ms = 0.0;  // of one image, one pair of images, its matches

  double rate() const { return pairs > 0 ? 100.0 * effective / pairs : 0.0; }  // percent
};

// How far pairs moved, and what became of them.
struct DisplacementHistogram {
  static constexpr double kWidth = 2.0;      // pixels a bin
  static constexpr std::size_t kBins = 101;  // the last one also has all that moved farther
  struct Bin {
    int effective_kept = 0, effective_removed = 0, wrong_kept = 0, wrong_removed = 0;
  };
  std::array<Bin, kBins> bins{};
};

// Distance (pixels) of a pair from the true motion, as above.
class MotionCheck {
 public:
  MotionCheck(const StereoCamera& camera, const SE3& T_21);
  double distance(const Eigen::Vector2d& first, const Eigen::Vector2d& second) const;

 private:
  bool still_;
  Eigen::Matrix3d F_, H_;
};

class MatchingEvaluation {
 public:
  MatchingEvaluation(const StereoCamera& camera, const MatchingSettings& settings);
  ~MatchingEvaluation();
  MatchingEvaluation(const MatchingEvaluation&) = delete;
  MatchingEvaluation& operator=(const MatchingEvaluation&) = delete;

  // The next images of the sequence and where the left one was taken. Without a right image or depth no
  // feature has depth.
  void add(const StereoImages& images, const SE3& T_wc);

  const MatchingCounts& counts(MatchingMethod method) const {
    return counts_[static_cast<std::size_t>(method)];
  }
  // Of the methods with a filter.
  const DisplacementHistogram& histogram(MatchingMethod method) const {
    return histograms_[static_cast<std::size_t>(method)];
  }

 private:
  struct Image;
  std::vector<MatchedPixels> match_orb(const Image& now) const;
  void add_pairs(MatchingMethod method, const std::vector<MatchedPixels>& pairs, const MotionCheck& check,
                 double extract_ms, double match_ms);

  const StereoCamera camera_;
  const MatchingSettings settings_;
  std::unique_ptr<MatchingBaseline> baseline_;
  std::unique_ptr<Image> before_;
  MotionModel motion_;  // up to the image before
  std::array<MatchingCounts, kMatchingMethods.size()> counts_;
  std::array<DisplacementHistogram, kMatchingMethods.size()> histograms_;
};

}  // namespace penumbra::slam
