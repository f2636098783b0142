// penumbra-sift: `match-eval` with OpenCV's SIFT beside our features. A target of its own, built on request
// where OpenCV is, for `penumbra` does without OpenCV.
#include <exception>
#include <memory>
#include <opencv2/features2d.hpp>
#include <vector>

#include "apps/common/log.h"
#include "apps/evaluate/match_eval_command.h"
#include "nn/base/error.h"
#include "nn/base/stopwatch.h"

namespace {

class SiftBaseline : public penumbra::slam::MatchingBaseline {
 public:
  std::string name() const override { return "SIFT"; }

  Pairs match(const penumbra::ByteView& grey) override {
    const cv::Mat image(grey.height, grey.width, CV_8UC1, const_cast<std::uint8_t*>(grey.data),
                        static_cast<std::size_t>(grey.pitch));
    Pairs pairs;
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    const penumbra::Stopwatch extracting;
    cv::SIFT::create()->detectAndCompute(image, cv::noArray(), points, descriptors);
    pairs.extract_ms = extracting.milliseconds();
    if (!descriptors_.empty() && !descriptors.empty()) {
      const penumbra::Stopwatch matching;
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

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  CLI::App app{"Penumbra's match-eval, with SIFT beside it", "penumbra-sift"};
  app.require_subcommand(1);
  penumbra::apps::add_match_eval_command(app, [] { return std::make_unique<SiftBaseline>(); });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    penumbra::apps::log_error("{}", error.what());
    return 1;
  }
  return 0;
}
