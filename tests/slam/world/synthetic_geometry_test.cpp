// The synthetic street's ground truth against geometry that is computed here, apart from the renderer.
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/features2d.hpp>
#include <random>

#include "tests/slam/world/synthetic_support.h"
#include "tests/support/cv_images.h"

namespace penumbra::slam::synthetic {
namespace {

TEST(SyntheticGeometry, DepthOfTheLeftImageLandsOnTheSameSurfaceInTheRight) {
  StreetSequence street({});
  const StereoCamera& camera = street.camera();
  std::mt19937 random(1);
  int compared = 0, wrong = 0;
  for (const int i : {0, 25, 50}) {
    SequenceFrame frame;
    street.render(i, frame);
    const TimedPose& pose = street.poses()[static_cast<std::size_t>(i)];
    FrameGeometry right;
    right.prepare(street.world(), camera, right_of(pose.T_wc, camera.baseline), pose.timestamp);
    for (int k = 0; k < 4000; ++k) {
      const int u = static_cast<int>(random() % 620), v = static_cast<int>(random() % 188);
      const double depth = frame.left.depth.at(u, v);
      if (depth <= 0.0) continue;
      Eigen::Vector3d point = camera.back_project(u, v, depth);
      point.x() -= camera.baseline;
      if (!camera.in_image(camera.project(point))) continue;
      const CastResult seen = cast_towards(right, point);
      if (seen.depth < 0.999 * depth || is_ragged(right, seen.surface)) continue;  // hidden, or foliage
      ++compared;
      const double disparity = camera.fx * camera.baseline / depth;
      wrong += std::abs(disparity - camera.fx * camera.baseline / seen.depth) > 0.02 ? 1 : 0;
    }
  }
  EXPECT_GT(compared, 5000);
  EXPECT_LE(wrong, compared / 1000);  // rays that graze a silhouette
}

TEST(SyntheticGeometry, TheRightDepthMapIsTheLeftOneShiftedByDisparity) {
  StreetSequence street({});
  const StereoCamera& camera = street.camera();
  SequenceFrame frame;
  street.render(10, frame);
  const double bf = camera.fx * camera.baseline;
  std::vector<double> errors;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      if (frame.left.depth.at(u, v) <= 0.0F) continue;
      const double disparity = bf / frame.left.depth.at(u, v), target = u - disparity;
      const int at = static_cast<int>(std::floor(target));
      if (at < 0 || at + 1 >= camera.width) continue;
      const double here = frame.right.depth.at(at, v), next = frame.right.depth.at(at + 1, v);
      if (here <= 0.0 || next <= 0.0) continue;
      const double d0 = bf / here, d1 = bf / next;
      // Where one plane covers both pixels disparity runs linearly between them.
      if (std::abs(d0 - d1) > 0.1) continue;
      const double error = d0 + (target - at) * (d1 - d0) - disparity;
      if (error < 0.3) errors.push_back(std::abs(error));  // else hidden by something nearer
    }
  }
  ASSERT_GT(errors.size(), 50000U);
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() * 98 / 100], 0.02);
}

TEST(SyntheticGeometry, TheGroundLiesWhereThePoseSaysItDoes) {
  StreetSequence street({});
  const StereoCamera& camera = street.camera();
  SequenceFrame frame;
  street.render(5, frame);
  const TimedPose& pose = street.poses()[5];
  FrameGeometry geometry;
  geometry.prepare(street.world(), camera, pose.T_wc, pose.timestamp);
  int ground = 0;
  for (int v = 0; v < camera.height; v += 3) {
    for (int u = 0; u < camera.width; u += 3) {
      const double depth = frame.left.depth.at(u, v);
      if (depth <= 0.0 || depth > 60.0) continue;
      const Eigen::Vector3d point = camera.back_project(u, v, depth);
      if (cast_towards(geometry, point).surface != kGround) continue;
      EXPECT_NEAR((pose.T_wc * point).y(), 0.0, 1e-4);
      ++ground;
    }
  }
  EXPECT_GT(ground, 1000);
}

TEST(SyntheticGeometry, InstanceMasksCoverExactlyTheirObjects) {
  StreetSequence street({});
  const StereoCamera& camera = street.camera();
  int masked = 0;
  for (const int i : {0, 20, 40}) {
    SequenceFrame frame;
    street.render(i, frame);
    const TimedPose& pose = street.poses()[static_cast<std::size_t>(i)];
    // Where a pixel's point lies in an object's own frame, against the object's box.
    const auto inside = [&](const Object& object, const Eigen::Vector3d& point, double grow) {
      const GroundPose at = pose_at(street.world(), object, pose.timestamp);
      const Eigen::Vector3d local = rotation_of(at.heading).transpose() *
                                    (point - Eigen::Vector3d(at.position.x(), 0.0, at.position.y()));
      return ((local - object.lower.cast<double>()).array() > -grow).all() &&
             ((object.upper.cast<double>() - local).array() > -grow).all();
    };
    for (int v = 0; v < camera.height; v += 2) {
      for (int u = 0; u < camera.width; u += 2) {
        if (frame.left.depth.at(u, v) <= 0.0F) continue;
        const Eigen::Vector3d point = pose.T_wc * camera.back_project(u, v, frame.left.depth.at(u, v));
        const int id = frame.left.instance.at(u, v);
        for (const Object& object : street.world().objects) {
          if (object.instance == 0) continue;
          if (object.instance == id) {
            EXPECT_TRUE(inside(object, point, 1e-2)) << "frame " << i << " pixel " << u << ", " << v;
            ++masked;
          } else if (object.object_class == ObjectClass::car) {
            EXPECT_FALSE(inside(object, point, -5e-2)) << "frame " << i << " pixel " << u << ", " << v;
          }
        }
      }
    }
  }
  EXPECT_GT(masked, 5000);
}

TEST(SyntheticGeometry, MovingCarsMoveAsTheirMotionSays) {
  StreetSequence street({.street = street_preset("crowded")});
  const StereoCamera& camera = street.camera();
  SequenceFrame frame;
  street.render(8, frame);
  const TimedPose& now = street.poses()[8];
  const TimedPose& next = street.poses()[9];
  FrameGeometry later;
  later.prepare(street.world(), camera, next.T_wc, next.timestamp);
  int followed = 0, kept = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const int id = frame.left.instance.at(u, v);
      const auto object = std::find_if(street.world().objects.begin(), street.world().objects.end(),
                                       [&](const Object& o) { return id != 0 && o.instance == id; });
      if (object == street.world().objects.end() || !object->motion.moves) continue;
      const GroundPose from = pose_at(street.world(), *object, now.timestamp);
      const GroundPose to = pose_at(street.world(), *object, next.timestamp);
      const SE3 before{rotation_of(from.heading), {from.position.x(), 0.0, from.position.y()}};
      const SE3 after{rotation_of(to.heading), {to.position.x(), 0.0, to.position.y()}};
      const Eigen::Vector3d point = next.T_wc.inverse() * after * before.inverse() * now.T_wc *
                                    camera.back_project(u, v, frame.left.depth.at(u, v));
      if (point.z() < 1.0 || !camera.in_image(camera.project(point))) continue;
      const CastResult seen = cast_towards(later, point);
      if (seen.depth < 0.999 * point.z()) continue;  // hidden by now
      ++followed;
      kept += std::abs(seen.depth - point.z()) < 1e-3 * point.z() ? 1 : 0;
    }
  }
  EXPECT_GT(followed, 300);
  EXPECT_GE(kept, followed * 99 / 100);
}

TEST(SyntheticGeometry, ImageMotionFollowsTheGroundTruthPoses) {
  StreetSequence street({});
  const StereoCamera& camera = street.camera();
  SequenceFrame first, second;
  street.render(3, first);
  street.render(4, second);
  const SE3 T_21 = street.poses()[4].T_wc.inverse() * street.poses()[3].T_wc;
  std::vector<cv::KeyPoint> corners;
  cv::FastFeatureDetector::create(20)->detect(test::to_mat(first.left_grey), corners);
  const cv::Mat first_grey = test::to_mat(first.left_grey), second_grey = test::to_mat(second.left_grey);
  constexpr int kPatch = 4, kSearch = 3;
  int tried = 0, found = 0;
  for (const cv::KeyPoint& corner : corners) {
    const int u = static_cast<int>(corner.pt.x), v = static_cast<int>(corner.pt.y);
    const float depth = first.left.depth.at(u, v);
    if (depth < 4.0F || first.left.instance.at(u, v) != 0) continue;
    const Eigen::Vector2d moved = camera.project(T_21 * camera.back_project(u, v, depth));
    const int mu = static_cast<int>(std::lround(moved.x())), mv = static_cast<int>(std::lround(moved.y()));
    constexpr int kBorder = kPatch + kSearch;
    const cv::Rect valid(kBorder, kBorder, camera.width - 2 * kBorder, camera.height - 2 * kBorder);
    if (!valid.contains({mu, mv}) || !valid.contains({u, v})) continue;
    const auto difference = [&](int du, int dv) {
      const cv::Size size(2 * kPatch + 1, 2 * kPatch + 1);
      return cv::norm(first_grey(cv::Rect({u - kPatch, v - kPatch}, size)),
                      second_grey(cv::Rect({mu + du - kPatch, mv + dv - kPatch}, size)), cv::NORM_L1);
    };
    double best = 1e9;
    int best_u = 0, best_v = 0;
    for (int dv = -kSearch; dv <= kSearch; ++dv) {
      for (int du = -kSearch; du <= kSearch; ++du) {
        if (difference(du, dv) < best) {
          best = difference(du, dv);
          best_u = du;
          best_v = dv;
        }
      }
    }
    ++tried;
    found += std::abs(best_u) <= 1 && std::abs(best_v) <= 1 ? 1 : 0;
  }
  EXPECT_GT(tried, 300);
  EXPECT_GT(found, tried * 85 / 100);
}

// A slanted wall seen from two places: pixels correspond by H = K (R + t n^T / d) K^-1.
TEST(SyntheticGeometry, ATexturedPlaneFollowsItsHomography) {
  World world;
  world.ground = false;
  Material plaster;
  plaster.seed = 5;
  Body wall = make_box({-40.0F, -40.0F, 0.0F}, {40.0F, 40.0F, 1.0F});
  wall.material = add_material(world, plaster);
  Object& object = add_object(world, {wall});
  object.pose = {{0.5, 6.0}, 0.35};

  const StereoCamera camera = street_camera({640, 480});
  const SE3 first;
  Vector6d twist;
  twist << 0.15, -0.06, 0.1, 0.01, -0.03, 0.02;
  const SE3 second = SE3::exp(twist);
  RayCaster caster(world);
  RenderedView a, b;
  caster.render(camera, first, 0.0, a);
  caster.render(camera, second, 0.0, b);

  // The wall's front face: n . p = d in the first camera's frame.
  const Eigen::Vector3d n = rotation_of(0.35) * Eigen::Vector3d::UnitZ();
  const double d = n.dot(Eigen::Vector3d(0.5, 0.0, 6.0));
  const SE3 T_21 = second.inverse() * first;
  Eigen::Matrix3d K;
  K << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  const Eigen::Matrix3d H = K * (T_21.rotation + T_21.translation * n.transpose() / d) * K.inverse();

  // Only pixels that land close to a pixel's centre: no interpolation between samples is needed.
  double difference = 0.0, shifted = 0.0, contrast = 0.0;
  int compared = 0;
  for (int v = 20; v < 460; ++v) {
    for (int u = 20; u < 620; ++u) {
      const Eigen::Vector2d p = (H * Eigen::Vector3d(u, v, 1.0)).hnormalized();
      const int pu = static_cast<int>(std::lround(p.x())), pv = static_cast<int>(std::lround(p.y()));
      if (pu < 4 || pv < 4 || pu >= 636 || pv >= 476) continue;
      if (std::abs(p.x() - pu) > 0.04 || std::abs(p.y() - pv) > 0.04) continue;
      const double light = a.radiance.at(u, v)[1];
      difference += std::abs(light - b.radiance.at(pu, pv)[1]);
      shifted += std::abs(light - b.radiance.at(pu + 2, pv)[1]);
      contrast += light;
      ++compared;
    }
  }
  ASSERT_GT(compared, 500);
  EXPECT_LT(difference / contrast, 0.02);
  EXPECT_GT(shifted, 5.0 * difference);
}

}  // namespace
}  // namespace penumbra::slam::synthetic
