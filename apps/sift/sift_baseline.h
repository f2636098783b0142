// OpenCV's SIFT, each other's nearest descriptors, beside our features.
#pragma once

#include <memory>
#include <opencv2/features2d.hpp>
#include <string>
#include <vector>

#include "nn/base/stopwatch.h"
#include "slam/evaluation/matching_evaluation.h"

namespace penumbra::apps {

class SiftBaseline : public slam::MatchingBaseline {
 public:
  std::string name() const override { return "SIFT"; }

  Pairs match(const ByteView& grey) override {
    const cv::Mat image(grey.height, grey.width, CV_8UC1, const_cast<std::uint8_t*>(grey.data),
                        static_cast<std::size_t>(grey.pitch));
    Pairs pairs;
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    const Stopwatch extracting;
    cv::SIFT::create()->detectAndCompute(image, cv::noArray(), points, descriptors);
    pairs.extract_ms = extracting.milliseconds();
    if (!descriptors_.empty() && !descriptors.empty()) {
      const Stopwatch matching;
      std::vector<cv::DMatch> matches;
      cv::BFMatcher(cv::NORM_L2, true).match(descriptors_, descriptors, matches);
      for (const cv::DMatch& m : matches) {
        const cv::Point2f a = points_[static_cast<std::size_t>(m.queryIdx)].pt;
        const cv::Point2f b = points[static_cast<std::size_t>(m.trainIdx)].pt;
        pairs.pixels.push_back({{a.x, a.y}, {b.x, b.y}});
      }
      pairs.match_ms = matching.milliseconds();
    }
    points_ = std::move(points);
    descriptors_ = descriptors;
    return pairs;
  }

 private:
  std::vector<cv::KeyPoint> points_;  // of the image before
  cv::Mat descriptors_;
};

}  // namespace penumbra::apps
