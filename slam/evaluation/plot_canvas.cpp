#include "slam/evaluation/plot_canvas.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace penumbra::slam {

cv::Point scaled(const cv::Point2d& point) {
  return {cv::saturate_cast<int>(point.x * kSupersampling), cv::saturate_cast<int>(point.y * kSupersampling)};
}

void draw_text(cv::Mat& canvas, const std::string& text, cv::Point2d position, double height, Anchor anchor,
               const cv::Scalar& colour, bool bold) {
  constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
  const int thickness = bold ? 4 : 2;
  const double scale =
      cv::getFontScaleFromHeight(kFont, static_cast<int>(std::lround(height * kSupersampling)), thickness);
  const cv::Size size = cv::getTextSize(text, kFont, scale, thickness, nullptr);
  const double shift = anchor == Anchor::left ? 0.0 : anchor == Anchor::centre ? 0.5 : 1.0;
  const cv::Point origin(cv::saturate_cast<int>(position.x * kSupersampling - shift * size.width),
                         cv::saturate_cast<int>(position.y * kSupersampling));
  cv::putText(canvas, text, origin, kFont, scale, colour, thickness, cv::LINE_AA);
}

int text_width(const std::string& text, double height) {
  constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
  const double scale =
      cv::getFontScaleFromHeight(kFont, static_cast<int>(std::lround(height * kSupersampling)), 2);
  return cv::getTextSize(text, kFont, scale, 2, nullptr).width / kSupersampling;
}

double round_step(double smallest) {
  const double power = std::pow(10.0, std::floor(std::log10(smallest)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= smallest) return factor * power;
  }
  return 10.0 * power;
}

}  // namespace penumbra::slam
