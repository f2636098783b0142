#include "slam/pipeline/stereo_view.h"

#include <algorithm>

#include "nn/base/ceil_div.h"
#include "nn/image/grey.h"
#include "nn/image/resize.h"

namespace penumbra::slam {

namespace {

DisparitySettings match_settings(const StereoDepthSettings& settings) {
  DisparitySettings match = settings.match;
  match.disparities = ceil_div(settings.disparities, settings.shrink);
  return match;
}

StereoCamera shrunk(const StereoCamera& camera, const Size& size) {
  const double x = static_cast<double>(size.width) / camera.width;
  const double y = static_cast<double>(size.height) / camera.height;
  StereoCamera small = camera;
  small.fx *= x;
  small.fy *= y;
  small.cx = (camera.cx + 0.5) * x - 0.5;
  small.cy = (camera.cy + 0.5) * y - 0.5;
  small.disparity_offset *= x;
  small.width = size.width;
  small.height = size.height;
  return small;
}

}  // namespace

StereoViewMaker::StereoViewMaker(const StereoDepthSettings& settings, double farthest)
    : shrink_(settings.shrink),
      units_(std::min(DenseView::kDepthUnits, static_cast<float>(50000.0 / farthest))),
      disparity_(match_settings(settings)) {}

DenseView StereoViewMaker::make(const StereoCamera& camera, const StereoImages& images) {
  const Size size{std::max(1, camera.width / shrink_), std::max(1, camera.height / shrink_)};
  const StereoCamera small = shrunk(camera, size);
  const ByteImage left = resize_area(images.left, size), right = resize_area(images.right, size);
  const FloatImage& disparity = disparity_.find(to_grey(left), to_grey(right));
  depth_.create(size.width, size.height);
  const auto offset = static_cast<float>(small.disparity_offset);
  const auto depth_1 = static_cast<float>(small.fx * small.baseline);  // of a disparity of one pixel
  std::transform(disparity.data(), disparity.data() + disparity.elements(), depth_.data(),
                 [&](float d) { return d > 0.0F && d > offset ? depth_1 / (d - offset) : 0.0F; });
  // A floor that lies low has steps of its own from row to row.
  DenseView view = make_dense_view(small, left, depth_, 1, {.units = units_, .least_jump = 1.0F / depth_1});
  view.step = shrink_;
  return view;
}

}  // namespace penumbra::slam
