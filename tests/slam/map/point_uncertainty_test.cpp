#include "slam/map/point_uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

#include "slam/map/map.h"
#include "slam/map/ply.h"
#include "tests/slam/world/synthetic.h"

namespace penumbra::slam {
namespace {

// Keyframes along x that see one point, with or without stereo.
class PointUncertainty : public ::testing::Test {
 protected:
  MapPoint* see(const Eigen::Vector3d& position, const std::vector<double>& places, bool stereo) {
    MapPoint* point = nullptr;
    for (const double x : places) {
      auto features = std::make_shared<FrameFeatures>();
      SE3 T_cw;
      T_cw.translation.x() = -x;
      const Eigen::Vector3d pixel = camera.project_stereo(T_cw * position);
      features->left.keypoints.push_back(
          {static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), 0, 0, 1});
      features->left.descriptors.push_back({});
      features->u_right.push_back(stereo ? static_cast<float>(pixel.z()) : -1.0F);
      features->depth.push_back(stereo ? static_cast<float>(position.z()) : -1.0F);
      features->colour.push_back({});
      features->grid = FeatureGrid(features->left.keypoints, camera.width, camera.height);
      const int number = static_cast<int>(map.keyframes().size());
      KeyFrame* keyframe = map.add_keyframe(number, number, T_cw, features);
      if (point == nullptr) {
        point = map.add_point(position, keyframe, 0);
      } else {
        map.add_observation(point, keyframe, 0);
      }
    }
    return point;
  }
  double uncertainty(const MapPoint& point) const {
    return relative_distance_uncertainty(point, camera, map.scales());
  }

  StereoCamera camera = test::test_camera();
  Map map{camera, {1.0}};
};

// sigma_Z / Z = Z sigma_d / (fx b), straight ahead.
TEST_F(PointUncertainty, OfOnePairIsTheStereoFormula) {
  for (const double z : {5.0, 50.0, 5000.0}) {
    const double expected = z * kCornerSigma / (camera.fx * camera.baseline);
    EXPECT_NEAR(uncertainty(*see({0.0, 0.0, z}, {0.0}, true)), expected, 1e-6 * expected) << z;
  }
}

// Two single views `step` apart are a stereo pair of that baseline: one of them looks straight at the point.
TEST_F(PointUncertainty, OfViewsApartFallsWithTheirDistance) {
  const double z = 40.0, step = 2.0;
  const double across = z * kCornerSigma / (camera.fx * step);
  EXPECT_NEAR(uncertainty(*see({0.0, 0.0, z}, {0.0, step}, false)), across, 0.01 * across);
  EXPECT_GT(uncertainty(*see({0.0, 0.0, z}, {0.0, 0.01}, false)), kMostRelativeUncertainty);
}

TEST_F(PointUncertainty, IsInfiniteWhereNothingTells) {
  EXPECT_TRUE(std::isinf(uncertainty(MapPoint())));
  EXPECT_TRUE(std::isinf(uncertainty(*see({0.0, 0.0, 10.0}, {0.0}, false)))) << "one direction";
  MapPoint* behind = see({0.0, 0.0, 10.0}, {0.0}, true);
  behind->position.z() = -10.0;
  EXPECT_TRUE(std::isinf(uncertainty(*behind)));
}

// A cloud at half a pixel of disparity is somewhere beyond: it is no place in a point cloud.
TEST_F(PointUncertainty, LeavesPointsWithoutAPlaceOutOfThePly) {
  see({0.0, 0.0, 20.0}, {0.0}, true);
  see({0.0, 0.0, 2.0 * camera.fx * camera.baseline}, {0.0}, true);
  const PointCloud cloud = point_cloud_of(map);
  EXPECT_EQ(cloud.left_out, 1);
  EXPECT_EQ(cloud.keyframes, 2);
  ASSERT_EQ(cloud.vertices.size(), 3U);
  EXPECT_EQ(cloud.vertices[0].position[2], 20.0F);
}

}  // namespace
}  // namespace penumbra::slam
