// The street's per-frame ground truth and sensors, and its presets.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <opencv2/features2d.hpp>

#include "nn/base/error.h"
#include "slam/frontend/features/orb_extractor.h"
#include "slam/world/depth_sensor.h"
#include "slam/world/ground_truth_images.h"
#include "tests/slam/world/synthetic_support.h"
#include "tests/support/cv_images.h"

namespace penumbra::slam::synthetic {
namespace {

TEST(SyntheticTruth, FlowOfWhatStandsStillIsThatOfThePoses) {
  StreetSequence street({.flow = true});
  SequenceFrame frame;
  street.render(30, frame);  // in a bend
  const SE3 motion = street.poses()[31].T_wc.inverse() * street.poses()[30].T_wc;
  int compared = 0;
  for (int v = 0; v < 188; v += 2) {
    for (int u = 0; u < 620; u += 2) {
      const double z = frame.left.depth.at(u, v);
      if (z <= 0.0) {
        EXPECT_EQ(frame.flow.at(u, v)[2], 0.0F);
        continue;
      }
      if (frame.left.instance.at(u, v) != 0) continue;
      const Eigen::Vector3d point = motion * street.camera().back_project(u, v, z);
      if (point.z() < 0.5) continue;
      const Eigen::Vector2d pixel = street.camera().project(point);
      EXPECT_NEAR(frame.flow.at(u, v)[0], pixel.x() - u, 0.02);
      EXPECT_NEAR(frame.flow.at(u, v)[1], pixel.y() - v, 0.02);
      ++compared;
    }
  }
  EXPECT_GT(compared, 10000);
}

TEST(SyntheticTruth, FlowLeadsToTheSameObjectInTheNextFrame) {
  StreetSequence street({.street = street_preset("crowded"), .flow = true});
  SequenceFrame now, next;
  street.render(12, now);
  street.render(13, next);
  int on_objects = 0, same = 0;
  double depth_off = 0.0;
  for (int v = 0; v < 188; ++v) {
    for (int u = 0; u < 620; ++u) {
      const std::array<float, 3>& flow = now.flow.at(u, v);
      const int id = now.left.instance.at(u, v);
      const int to_u = static_cast<int>(std::lround(static_cast<float>(u) + flow[0]));
      const int to_v = static_cast<int>(std::lround(static_cast<float>(v) + flow[1]));
      if (id == 0 || flow[2] == 0.0F || to_u < 0 || to_v < 0 || to_u >= 620 || to_v >= 188) continue;
      ++on_objects;
      same += next.left.instance.at(to_u, to_v) == id ? 1 : 0;
      depth_off += next.left.depth.at(to_u, to_v) < 0.5F * now.left.depth.at(u, v) ? 1.0 : 0.0;
    }
  }
  EXPECT_GT(on_objects, 5000);
  EXPECT_GT(same, on_objects * 9 / 10);  // the rest is hidden in the next frame, or an edge
  EXPECT_LT(depth_off, 0.05 * on_objects);
}

TEST(SyntheticTruth, TheLastFrameHasNoFlow) {
  StreetSequence street({.path = "straight", .frames = 2, .size = {64, 48}, .flow = true});
  SequenceFrame first, last;
  street.render(0, first);
  EXPECT_FALSE(first.flow.empty());
  street.render(1, last);
  EXPECT_TRUE(last.flow.empty());
}

TEST(SyntheticTruth, EncodedImagesFollowTheirFormats) {
  const StereoCamera camera = street_camera({620, 188});
  FloatImage depth(4, 1);
  for (const int i : {0, 1, 2, 3}) depth.at(i, 0) = i == 0 ? 0.0F : std::pow(10.0F, static_cast<float>(i));
  const WordImage levels = encode_depth(depth, 256.0F), disparity = encode_disparity(depth, camera);
  EXPECT_EQ(levels.at(0, 0), 0);
  EXPECT_EQ(levels.at(1, 0), 2560);
  EXPECT_EQ(levels.at(3, 0), 0);  // beyond 255 m
  EXPECT_EQ(disparity.at(0, 0), 0);
  for (const int i : {1, 2, 3}) {
    const double expected = camera.fx * camera.baseline / static_cast<double>(depth.at(i, 0));
    EXPECT_NEAR(disparity.at(i, 0) / 256.0, expected, 0.5 / 256.0 + 1e-9);
  }
  FlowImage flow(3, 1);
  flow.at(0, 0) = {1.5F, -20.25F, 1.0F};
  flow.at(1, 0) = {3.0F, 4.0F, 0.0F};
  flow.at(2, 0) = {600.0F, 0.0F, 1.0F};
  const WordImage encoded = encode_flow(flow);
  const std::vector<std::uint16_t> codes(encoded.data(), encoded.data() + encoded.elements());
  EXPECT_EQ(codes, (std::vector<std::uint16_t>{1, 32768 - 20 * 64 - 16, 32768 + 96, 0, 0, 0, 0, 0, 0}));
}

TEST(SyntheticTruth, DepthNoiseOfTheRgbdSensorGrowsWithTheSquareOfDepth) {
  StreetSequence street({.sensor = Sensor::rgbd, .size = {640, 480}});
  SequenceFrame frame;
  street.render(0, frame);
  EXPECT_TRUE(frame.left_grey.empty());
  ASSERT_EQ(frame.left_bgr.size(), (Size{640, 480}));
  double near = 0.0, far = 0.0;
  int nears = 0, fars = 0, holes = 0, in_range = 0;
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const double z = frame.left.depth.at(u, v), sensed = frame.sensed_depth.at(u, v);
      if (z < 0.4 || z > 12.0) {
        EXPECT_EQ(sensed, 0.0);
        continue;
      }
      ++in_range;
      if (sensed == 0.0) {
        ++holes;
        continue;
      }
      const double scaled = (sensed - z) / (z * z);
      (z < 5.0 ? near : far) += scaled * scaled;
      ++(z < 5.0 ? nears : fars);
    }
  }
  ASSERT_GT(nears, 10000);
  ASSERT_GT(fars, 10000);
  EXPECT_NEAR(std::sqrt(near / nears), 0.0014, 0.0001);
  EXPECT_NEAR(std::sqrt(far / fars), 0.0014, 0.0001);
  EXPECT_GT(holes, in_range / 50);
  EXPECT_LT(holes, in_range / 2);
}

TEST(SyntheticTruth, TheProjectorsShadowLiesLeftOfANearerSurface) {
  RenderedView view;
  view.depth = FloatImage::filled(200, 1, 8.0F);
  std::fill_n(&view.depth.at(100, 0), 40, 1.0F);
  view.reflectance = Image<Reflectance>::filled(200, 1, {0.5F, 0.0F});
  const StereoCamera camera = street_camera({200, 100});
  FloatImage depth;
  sense_depth(view, camera, 1, depth);
  const double gap = camera.fx * kProjectorBaseline * (1.0 - 1.0 / 8.0);  // 7.6 pixels
  for (int u = 0; u < 200; ++u) {
    const bool hidden = u < 100 && u >= 100.0 - gap;
    EXPECT_EQ(depth.at(u, 0) == 0.0F, hidden) << u;
  }
}

// Share of the image that shows the lorry which leads the camera, frame by frame.
std::vector<double> share_of_lorry(const char* preset, int frames) {
  StreetSequence street({.street = street_preset(preset), .frames = frames, .size = {155, 47}});
  int id = 0;
  for (const Object& object : street.world().objects) {
    if (object.motion.leads) id = object.instance;
  }
  EXPECT_NE(id, 0);
  std::vector<double> shares;
  SequenceFrame frame;
  for (int i = 0; i < frames; i += 6) {
    street.render(i, frame);
    const std::uint16_t* ids = frame.left.instance.data();
    shares.push_back(static_cast<double>(std::count(ids, ids + 155 * 47, id)) / (155.0 * 47.0));
  }
  return shares;
}

TEST(SyntheticTruth, TheLorryHidesItsShareOfTheImageForTheWholeDrive) {
  // 284 frames: two thirds of the way round the block.
  for (const double share : share_of_lorry("lorry", 284)) {
    EXPECT_GT(share, 0.05);
    EXPECT_LT(share, 0.31);
  }
  const std::vector<double> close = share_of_lorry("lorry-close", 284);
  const double most = *std::max_element(close.begin(), close.end());
  EXPECT_GT(most, 0.7);
  EXPECT_LT(most, 0.9);
}

TEST(SyntheticTruth, TheShareOfMovingCarsIsWhatIsAskedFor) {
  const Drive drive = make_drive("straight", 200);
  const auto count = [&](float share) {
    StreetSettings settings = street_preset("street");
    settings.moving = share;
    settings.car_ahead = false;
    int moving = 0, all = 0;
    for (const Object& object : build_street(drive, settings, 1).objects) {
      if (object.object_class != ObjectClass::car && object.object_class != ObjectClass::truck) continue;
      ++all;
      moving += object.motion.moves ? 1 : 0;
    }
    EXPECT_GT(all, 20);
    return static_cast<double>(moving) / all;
  };
  EXPECT_EQ(count(0.0F), 0.0);
  EXPECT_NEAR(count(0.2F), 0.2, 0.08);
  EXPECT_EQ(count(1.0F), 1.0);
}

TEST(SyntheticTruth, SettingsChangeWhatTheyShould) {
  const auto image = [](const StreetSettings& settings) {
    StreetSequence street({.street = settings, .path = "straight", .size = {310, 94}});
    SequenceFrame frame;
    street.render(3, frame);
    return test::to_mat(frame.left_grey);
  };
  const auto corners = [](const cv::Mat& grey) {
    std::vector<cv::KeyPoint> found;
    cv::FastFeatureDetector::create(20)->detect(grey, found);
    return found.size();
  };
  const cv::Mat normal = image({});
  StreetSettings settings;
  settings.texture = 0.0F;
  EXPECT_LT(corners(image(settings)), corners(normal) * 4 / 5);
  settings = {};
  settings.noise = 0.0F;
  const cv::Mat clean = image(settings);
  EXPECT_NEAR(cv::norm(clean, normal, cv::NORM_L2) / std::sqrt(310.0 * 94.0), 1.3, 0.2);
  settings.shutter = 0.1F;
  EXPECT_LT(corners(image(settings)), corners(clean) * 4 / 5);
  for (const Light light : {Light::overcast, Light::evening}) {
    settings = {};
    settings.light = light;
    EXPECT_GT(cv::norm(image(settings), normal, cv::NORM_L1) / (310.0 * 94.0), 3.0);
  }
  settings = {};
  settings.glare = 1.0F;
  EXPECT_GT(cv::norm(image(settings), normal, cv::NORM_L1) / (310.0 * 94.0), 3.0);
}

TEST(SyntheticTruth, ValuesOutOfRangeAreUsageErrors) {
  const auto expect_refused = [](const auto& change) {
    SequenceSettings settings;
    change(settings);
    EXPECT_THROW(StreetSequence{settings}, UsageError);
  };
  expect_refused([](SequenceSettings& s) { s.street.moving = 1.5F; });
  expect_refused([](SequenceSettings& s) { s.street.parked_cars = -0.1F; });
  expect_refused([](SequenceSettings& s) { s.street.texture = NAN; });
  expect_refused([](SequenceSettings& s) { s.street.lorry = LorryAhead{0.0F, 5.0F}; });
  expect_refused([](SequenceSettings& s) { s.street.lorry = LorryAhead{9.0F, 5.0F}; });
  expect_refused([](SequenceSettings& s) { s.street.shutter = 1.0F; });
  expect_refused([](SequenceSettings& s) {
    s.sensor = Sensor::rgbd;
    s.flow = true;
  });
}

// A SLAM system needs features near (they fix the translation) and far (they fix the rotation).
TEST(SyntheticTruth, OrbFindsFeaturesAtAllDepths) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    StreetSequence street({.size = {1241, 376}, .seed = seed});
    SequenceFrame frame;
    street.render(20, frame);
    Features features;
    OrbExtractor({}).extract(frame.left_grey, features);
    int near = 0, middle = 0, far = 0;
    for (const Keypoint& point : features.keypoints) {
      const float z = frame.left.depth.at(static_cast<int>(point.u), static_cast<int>(point.v));
      near += z > 0.0F && z < 12.0F ? 1 : 0;
      middle += z >= 12.0F && z < 30.0F ? 1 : 0;
      far += z >= 30.0F ? 1 : 0;
    }
    EXPECT_GT(near, 150) << "seed " << seed;
    EXPECT_GT(middle, 150) << "seed " << seed;
    EXPECT_GT(far, 150) << "seed " << seed;
  }
}

}  // namespace
}  // namespace penumbra::slam::synthetic
