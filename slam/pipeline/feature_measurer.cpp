#include "slam/pipeline/feature_measurer.h"

#include <cmath>
#include <future>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/image/grey.h"
#include "slam/frontend/features/depth_measurement.h"

namespace penumbra::slam {

namespace {

void check_image(const ByteImage& image, const StereoCamera& camera, int index, const char* side) {
  if (image.width() == camera.width && image.height() == camera.height &&
      (image.channels() == 1 || image.channels() == 3)) {
    return;
  }
  throw InputError(
      fmt::format("frame {}, {} image", index, side),
      fmt::format("{}x{}, 8-bit grey or BGR", camera.width, camera.height),
      fmt::format("{}x{} with {}", image.width(), image.height(), counted(image.channels(), "channel")));
}

void check_depth(const FloatImage& depth, const StereoCamera& camera, int index) {
  if (depth.width() == camera.width && depth.height() == camera.height && depth.channels() == 1) return;
  throw InputError(
      fmt::format("frame {}, depth", index),
      fmt::format("{}x{}, metres as 32-bit floats", camera.width, camera.height),
      fmt::format("{}x{} with {}", depth.width(), depth.height(), counted(depth.channels(), "channel")));
}

// Colour of the image at each keypoint.
std::vector<std::array<std::uint8_t, 3>> colours_at(const ByteImage& image,
                                                    const std::vector<Keypoint>& keypoints) {
  std::vector<std::array<std::uint8_t, 3>> colours;
  colours.reserve(keypoints.size());
  for (const Keypoint& k : keypoints) {
    const int x = static_cast<int>(std::lround(k.u)), y = static_cast<int>(std::lround(k.v));
    const std::uint8_t* c = &image.at(x, y);
    const int step = image.channels() == 3 ? 1 : 0;
    colours.push_back({c[0], c[step], c[2 * step]});
  }
  return colours;
}

}  // namespace

void FeatureMeasurer::check(const StereoImages& images, const StereoCamera& camera) const {
  check_image(images.left, camera, images.index, "left");
  if (sensor_ == Sensor::stereo) {
    check_image(images.right, camera, images.index, "right");
  } else {
    check_depth(images.depth, camera, images.index);
  }
}

std::shared_ptr<const FrameFeatures> FeatureMeasurer::measure(const StereoImages& images,
                                                              const StereoCamera& camera, double more,
                                                              StageTimer& timer, const SE3& T_dc) {
  auto measured = std::make_shared<FrameFeatures>();
  const ByteImage left = to_grey(images.left);
  StereoMatches stereo;
  if (sensor_ == Sensor::stereo) {
    const ByteImage right = to_grey(images.right);
    {
      const auto scope = timer.measure("orb");
      const auto policy = threads_ > 1 ? std::launch::async : std::launch::deferred;
      std::future<void> right_done = std::async(policy, [&] {
        const auto scope = right_timer_.measure("orb_right");
        right_orb_.extract(right, right_, more);
      });
      left_orb_.extract(left, measured->left, more);
      right_done.get();
    }
    const auto scope = timer.measure("stereo");
    match_stereo(camera, measured->left, right_, left_orb_.pyramid(), right_orb_.pyramid(), stereo);
    stereo_order_.check(images.index, camera, measured->left, right_, left_orb_.pyramid(),
                        right_orb_.pyramid(), stereo);
  } else {
    {
      const auto scope = timer.measure("orb");
      left_orb_.extract(left, measured->left, more);
    }
    const auto scope = timer.measure("stereo");
    measure_depth(camera, measured->left, images.depth, stereo, T_dc);
  }
  measured->u_right = std::move(stereo.u_right);
  measured->depth = std::move(stereo.depth);
  measured->colour = colours_at(images.left, measured->left.keypoints);
  measured->grid = FeatureGrid(measured->left.keypoints, camera.width, camera.height);
  return measured;
}

}  // namespace penumbra::slam
